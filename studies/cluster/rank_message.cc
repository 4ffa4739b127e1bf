#include "mjdiag/studies/cluster/rank_message.h"

#include <string_view>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_bytes.h"

namespace mjdiag {
namespace {

/// The numbers first, as they lie in memory: ranks of a job run on computers of a kind.
template <typename T>
void PutAll(std::string& bytes, const std::vector<T>& values) {
  AppendBytes(static_cast<std::uint64_t>(values.size()), bytes);
  for (const T& value : values) AppendBytes(value, bytes);
}

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  template <typename T>
  T Get() {
    Require(sizeof(T));
    return TakeNumber<T>(bytes_);
  }
  template <typename T>
  std::vector<T> GetAll() {
    const auto count = Get<std::uint64_t>();
    if (count > bytes_.size()) Require(bytes_.size() + 1);
    std::vector<T> values;
    values.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) values.push_back(Get<T>());
    return values;
  }
  std::string Rest() const { return std::string(bytes_); }

 private:
  void Require(std::size_t size) const {
    if (size <= bytes_.size()) return;
    throw InputError("message of a rank", "is cut off", "mjdiag of one version");
  }

  std::string_view bytes_;  // that are left
};

}  // namespace

std::string Packed(const RankReport& report) {
  std::string bytes;
  AppendBytes(report.kind, bytes);
  AppendBytes(report.threads, bytes);
  AppendBytes(report.study, bytes);
  PutAll(bytes, report.done);
  AppendBytes(report.run, bytes);
  AppendBytes(report.bad_input, bytes);
  return bytes + report.text;
}

std::string Packed(const RankOrder& order) {
  std::string bytes;
  AppendBytes(order.kind, bytes);
  PutAll(bytes, order.runs);
  return bytes;
}

RankReport UnpackedReport(const std::string& bytes) {
  Reader reader(bytes);
  RankReport report;
  report.kind = reader.Get<RankReport::Kind>();
  report.threads = reader.Get<std::uint32_t>();
  report.study = reader.Get<std::uint64_t>();
  report.done = reader.GetAll<std::int64_t>();
  report.run = reader.Get<std::int64_t>();
  report.bad_input = reader.Get<bool>();
  report.text = reader.Rest();
  return report;
}

RankOrder UnpackedOrder(const std::string& bytes) {
  Reader reader(bytes);
  RankOrder order;
  order.kind = reader.Get<RankOrder::Kind>();
  order.runs = reader.GetAll<RunRange>();
  return order;
}

}  // namespace mjdiag
