// Records as text: what is read is written back, and reads the same.

#include "fuzz/target.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag::fuzz {
namespace {

void RequireSame(const Record& a, const Record& b) {
  Require(a.sample_time() == b.sample_time() && a.samples() == b.samples() &&
              a.channels().size() == b.channels().size(),
          "a record that comes back as another one");
  for (std::size_t i = 0; i < a.channels().size(); ++i) {
    Require(a.channels()[i].samples == b.channels()[i].samples,
            "samples that come back as others");
  }
}

Resampling StageSampling() {
  return {
      1e-3, {{"u", Course::kHeld}, {"s", Course::kSwitched}}, {{"q", {1e-6, 1e-6}}}};
}

}  // namespace

void FuzzCsv(Input input) {
  const auto file = WriteFile("record.csv", TextOf(input));
  Record record;
  if (Done([&] { record = ReadRecord(file); })) {
    const auto copy = Folder() / "copy.csv";
    if (Done([&] { WriteRecord(copy, record, RecordFormat::kCsv); })) {
      MustDo("a record that was written",
             [&] { RequireSame(record, ReadRecord(copy)); });
    }
  }
  Done([&] { ReadMeasuredFile(file, std::nullopt, StageSampling()); });
}

}  // namespace mjdiag::fuzz
