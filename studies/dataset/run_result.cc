#include "mjdiag/studies/dataset/run_result.h"

#include <string_view>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_bytes.h"

namespace mjdiag {
namespace {

class Writer {
 public:
  template <typename T>
  void Put(const T& value) {
    AppendBytes(value, bytes_);
  }
  void PutText(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  template <typename T>
  T Get() {
    Require(sizeof(T));
    return TakeNumber<T>(bytes_);
  }
  std::string GetText() {
    const auto size = Get<std::uint32_t>();
    Require(size);
    const std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return text;
  }
  std::size_t GetCount(std::size_t least_size) {
    const auto count = Get<std::uint32_t>();
    if (count > bytes_.size() / least_size) Fail();
    return count;
  }
  void RequireEnd() const {
    if (!bytes_.empty()) Fail();
  }

 private:
  [[noreturn]] static void Fail() {
    throw InputError("journal", "holds no result of a run", "one of this version");
  }
  void Require(std::size_t size) const {
    if (size > bytes_.size()) Fail();
  }

  std::string_view bytes_;  // that are left
};

}  // namespace

std::string Packed(const RunResult& result) {
  Writer writer;
  writer.PutText(result.failure);
  writer.Put(result.samples);
  writer.Put(static_cast<std::uint8_t>(result.detected));
  writer.Put(result.first_detection);
  writer.Put(result.lasting);
  writer.Put(static_cast<std::uint8_t>(result.disturbed));
  writer.Put(result.nis);
  writer.Put(result.residual_low);
  writer.Put(result.residual_high);
  writer.Put(static_cast<std::uint32_t>(result.faults.size()));
  for (const KeptEstimate& fault : result.faults) {
    writer.Put(fault.value);
    writer.Put(fault.sd);
    writer.Put(static_cast<std::uint8_t>(fault.named));
  }
  writer.Put(static_cast<std::uint32_t>(result.features.size()));
  for (const double feature : result.features) writer.Put(feature);
  return writer.Take();
}

RunResult Unpacked(const std::string& bytes) {
  Reader reader(bytes);
  RunResult result;
  result.failure = reader.GetText();
  result.samples = reader.Get<std::int64_t>();
  result.detected = reader.Get<std::uint8_t>() != 0;
  result.first_detection = reader.Get<double>();
  result.lasting = reader.Get<double>();
  result.disturbed = reader.Get<std::uint8_t>() != 0;
  result.nis = reader.Get<double>();
  result.residual_low = reader.Get<double>();
  result.residual_high = reader.Get<double>();
  constexpr std::size_t kEstimate = 2 * sizeof(double) + 1;
  result.faults.resize(reader.GetCount(kEstimate));
  for (KeptEstimate& fault : result.faults) {
    fault.value = reader.Get<double>();
    fault.sd = reader.Get<double>();
    fault.named = reader.Get<std::uint8_t>() != 0;
  }
  result.features.resize(reader.GetCount(sizeof(double)));
  for (double& feature : result.features) feature = reader.Get<double>();
  reader.RequireEnd();
  return result;
}

}  // namespace mjdiag
