#include "mjdiag/discovery/record_replay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/comparison/replay_error.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

std::vector<RecordReplay> ReplayAll(const Measurements& measurements,
                                    const Changes& changes, std::uint64_t seed,
                                    bool falls) {
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
      const FollowedPair pair = CompareFollowed(machine, changes, record);
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

bool AnyFalls(const Measurements& measurements) {
  const auto falls = [](const MeasuredRecord& one) {
    return Falls(one.machine, one.record);
  };
  return std::ranges::any_of(measurements.fit, falls) ||
         std::ranges::any_of(measurements.unseen, falls);
}

Eigen::MatrixXd FreeErrors(const std::vector<MeasuredRecord>& records,
                           const Changes& changes) {
  Eigen::Index samples = 0;
  std::vector<Eigen::Index> first;
  for (const MeasuredRecord& one : records) {
    first.push_back(samples);
    samples += one.record.samples();
  }
  const Channels& channels = records.front().machine.channels();
  Eigen::MatrixXd errors(static_cast<Eigen::Index>(channels.sensors.size()), samples);
  ParallelFor(static_cast<int>(records.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const auto& [record, machine, name, notes, own_plant] = records[i];
    RunOptions quiet;
    quiet.noise_scale = 0.0;
    const Record simulated =
        Simulate(machine.With(changes), Replay(machine.setup(), record), quiet);
    Eigen::Index row = 0;
    for (const SensorSetup& sensor : channels.sensors) {
      const Channel& measured = record.At(sensor.channel);
      Eigen::VectorXd error = measured.samples - simulated.At(sensor.channel).samples;
      if (measured.measured.size() > 0) error = measured.measured.select(error, 0.0);
      errors.row(row++).segment(first[i], record.samples()) = error;
    }
  });
  return errors;
}

double FreeRun(const std::vector<MeasuredRecord>& records, const Changes& changes,
               const Eigen::VectorXd& noise_sd) {
  double sum = 0.0;
  try {
    const Eigen::MatrixXd errors = FreeErrors(records, changes);
    Eigen::Index first = 0;
    for (const auto& [record, machine, name, notes, own_plant] : records) {
      const Eigen::Index skip = machine.setup().compare.skip_samples;
      const Eigen::Index n = record.samples() - skip;
      for (Eigen::Index i = 0; i < errors.rows(); ++i) {
        const Channel& measured =
            record.At(machine.channels().sensors[static_cast<std::size_t>(i)].channel);
        const Eigen::Index count =
            measured.measured.size() > 0
                ? std::max<Eigen::Index>(1, measured.measured.tail(n).count())
                : n;
        const double square = errors.row(i).segment(first + skip, n).squaredNorm() /
                              static_cast<double>(count);
        sum += 0.5 * std::log1p(square / (noise_sd[i] * noise_sd[i]));
      }
      first += record.samples();
    }
  } catch (const NumericalError&) {
    return std::numeric_limits<double>::infinity();
  }
  return sum / static_cast<double>(noise_sd.size() *
                                   static_cast<Eigen::Index>(records.size()));
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
