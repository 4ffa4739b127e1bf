#include "mjdiag/discovery/record_replay.h"

#include "mjdiag/comparison/replay_error.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

std::vector<RecordReplay> ReplayAll(const Measurements& measurements,
                                    const Changes& changes, std::uint64_t seed) {
  RunOptions options;
  options.seed = seed;
  std::vector<const MeasuredRecord*> records;
  std::vector<RecordReplay> replays;
  const auto add = [&](const std::vector<MeasuredRecord>& of, bool seen) {
    for (const MeasuredRecord& one : of) {
      records.push_back(&one);
      replays.push_back({one.name, seen, {}, {}});
    }
  };
  add(measurements.fit, true);
  add(measurements.unseen, false);
  ParallelFor(2 * static_cast<int>(records.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number / 2);
    const auto& [record, machine, name] = *records[i];
    if (number % 2 == 0) {
      replays[i].before = Compare(machine, record, options);
    } else {
      replays[i].after = Compare(machine.With(changes), record, options);
    }
  });
  return replays;
}

std::map<std::string, double> MeanReplayErrors(
    const std::vector<MeasuredRecord>& records, const Changes& changes) {
  std::map<std::string, double> mean;
  for (const auto& [record, machine, name] : records) {
    for (const auto& [signal, error] : ReplayErrors(machine, changes, record)) {
      mean[signal] += error / static_cast<double>(records.size());
    }
  }
  return mean;
}

}  // namespace mjdiag
