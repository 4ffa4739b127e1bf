#include "mjdiag/studies/cluster/rank_message.h"

#include <cstring>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

template <typename T>
void Put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The numbers first, as they lie in memory: ranks of a job run on computers of a kind.
template <typename T>
void PutAll(std::string& bytes, const std::vector<T>& values) {
  Put(bytes, static_cast<std::uint64_t>(values.size()));
  for (const T& value : values) Put(bytes, value);
}

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  template <typename T>
  T Get() {
    T value;
    Require(sizeof value);
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
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
  std::string Rest() const { return bytes_.substr(at_); }

 private:
  void Require(std::size_t size) const {
    if (size <= bytes_.size() - at_) return;
    throw InputError("message of a rank", "is cut off", "mjdiag of one version");
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::string Packed(const RankReport& report) {
  std::string bytes;
  Put(bytes, report.kind);
  Put(bytes, report.threads);
  Put(bytes, report.study);
  PutAll(bytes, report.done);
  Put(bytes, report.run);
  Put(bytes, report.bad_input);
  return bytes + report.text;
}

std::string Packed(const RankOrder& order) {
  std::string bytes;
  Put(bytes, order.kind);
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
