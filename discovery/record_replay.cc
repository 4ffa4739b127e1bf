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
                                    const Changes& changes, PhysicsSteps steps,
                                    std::uint64_t seed, bool falls,
                                    const FilterNoise& near) {
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
  ParallelFor(static_cast<int>(records.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const auto& [record, machine, name, notes, own_plant] = *records[i];
    if (falls) {
      // One filter is behind both.
      const FollowedPair pair = CompareFollowed(
          steps.Of(machine), steps.Of(machine.With(changes)), record, &near);
      replays[i].before = pair.before;
      replays[i].after = pair.after;
      return;
    }
    // What noise does is what it does to the better model.
    replays[i].after = CompareFree(steps.Of(machine.With(changes)), record, options);
    replays[i].before =
        CompareFree(steps.Of(machine), record, options, &replays[i].after);
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
    const std::vector<MeasuredRecord>& records, const Changes& changes,
    PhysicsSteps steps) {
  std::map<std::string, double> mean;
  for (const auto& [record, machine, name, notes, own_plant] : records) {
    for (const auto& [signal, error] :
         ReplayErrors(steps.Of(machine.With(changes)), record)) {
      mean[signal] += error / static_cast<double>(records.size());
    }
  }
  return mean;
}

}  // namespace mjdiag
