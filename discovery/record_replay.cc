#include "mjdiag/discovery/record_replay.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "mjdiag/comparison/replay_error.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"

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

double FreeRun(const std::vector<MeasuredRecord>& records, const Changes& changes,
               const Eigen::VectorXd& noise_sd) {
  std::vector<double> off(records.size());
  ParallelFor(static_cast<int>(records.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const auto& [record, machine, name] = records[i];
    RunOptions quiet;
    quiet.noise_scale = 0.0;
    try {
      const Record simulated =
          Simulate(machine.With(changes), Replay(machine.setup(), record), quiet);
      Eigen::Index sensor = 0;
      const Eigen::Index skip = machine.setup().compare.skip_samples;
      for (const SensorSetup& one : machine.channels().sensors) {
        const Eigen::VectorXd error =
            record.At(one.channel).samples - simulated.At(one.channel).samples;
        const double rms = Rms(error.tail(error.size() - skip));
        off[i] += 0.5 * std::log1p(std::pow(rms / noise_sd[sensor++], 2));
      }
    } catch (const NumericalError&) {
      off[i] = std::numeric_limits<double>::infinity();
    }
  });
  const double sum = std::accumulate(off.begin(), off.end(), 0.0);
  return sum / static_cast<double>(noise_sd.size() *
                                   static_cast<Eigen::Index>(records.size()));
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
