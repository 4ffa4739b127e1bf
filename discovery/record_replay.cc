#include "mjdiag/discovery/record_replay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/discovery/comparison/replay_error.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

std::vector<RecordReplay> ReplayAll(const Measurements& measurements,
                                    const Changes& changes, std::uint64_t seed,
                                    bool falls, const FilterNoise& near) {
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
    const auto& [record, machine, name, notes, own_plant] = *records[i];
    const bool is_before = number % 2 == 0;
    if (falls) {
      // One filter is behind both.
      if (!is_before) return;
      const FollowedPair pair = CompareFollowed(machine, changes, record, &near);
      replays[i].before = pair.before;
      replays[i].after = pair.after;
    } else if (is_before) {
      replays[i].before = CompareFree(machine, record, options);
    } else {
      replays[i].after = CompareFree(machine.With(changes), record, options);
    }
  });
  return replays;
}

bool AnyDivergesOpenLoop(const Measurements& measurements) {
  const auto falls = [](const MeasuredRecord& one) {
    return DivergesOpenLoop(one.machine, one.record);
  };
  return std::ranges::any_of(measurements.fit, falls) ||
         std::ranges::any_of(measurements.unseen, falls);
}

std::map<std::string, double> MeanReplayErrors(
    const std::vector<MeasuredRecord>& records, const Changes& changes) {
  std::map<std::string, double> mean;
  for (const auto& [record, machine, name, notes, own_plant] : records) {
    for (const auto& [signal, error] : ReplayErrors(machine, changes, record)) {
      mean[signal] += error / static_cast<double>(records.size());
    }
  }
  return mean;
}

}  // namespace mjdiag
