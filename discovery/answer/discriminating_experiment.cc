#include "mjdiag/discovery/answer/discriminating_experiment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// Long enough for every move of a trajectory that repeats.
constexpr double kLongest = 1.0;  // [s]

/// The trajectory with time stretched.
Trajectory Slower(Trajectory trajectory, double factor) {
  trajectory.period *= factor;
  for (Move& move : trajectory.moves) move.at *= factor;
  for (ReferenceTone& tone : trajectory.tones) tone.frequency /= factor;
  trajectory.ramp *= factor;
  for (auto& [axis, limits] : trajectory.limits) {
    limits.velocity /= factor;
    limits.acceleration /= std::pow(factor, 2);
    limits.jerk /= std::pow(factor, 3);
    limits.snap /= std::pow(factor, 4);
  }
  const double once = trajectory.period > 0.0 ? trajectory.period : trajectory.duration;
  trajectory.duration =
      std::min(trajectory.duration * factor, std::max(once, kLongest * factor));
  return trajectory;
}

Record RunOf(const Machine& machine, const Excitation& excitation,
             const Changes& changes) {
  RunOptions options;
  options.noise_scale = 0.0;
  return Simulate(machine.With(changes), excitation, options);
}

double Separation(const Setup& setup, const Record& a, const Record& b) {
  double sum = 0.0;
  for (const SensorSetup& sensor : setup.channels.sensors) {
    if (sensor.noise_sd <= 0.0) continue;
    sum += ((a.At(sensor.channel).samples - b.At(sensor.channel).samples) /
            sensor.noise_sd)
               .squaredNorm();
  }
  return std::sqrt(sum);
}

}  // namespace

std::optional<DiscriminatingExperiment> FindDiscriminatingExperiment(
    const Machine& machine, const Changes& one, const Changes& other) {
  if (machine.setup().control.axes.empty()) return std::nullopt;
  // The slowest, which take longest, first.
  std::vector<DiscriminatingExperiment> experiments;
  for (const double slower : {5.0, 2.0, 1.0}) {
    for (const Trajectory& trajectory : machine.setup().trajectories.all) {
      experiments.push_back({trajectory.name, slower, 0.0});
    }
  }
  std::vector<std::array<std::optional<Record>, 2>> runs(experiments.size());
  ParallelFor(2 * static_cast<int>(experiments.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number / 2);
    const auto which = static_cast<std::size_t>(number % 2);
    const DiscriminatingExperiment& experiment = experiments[i];
    try {
      const Excitation excitation = FollowTrajectory(
          machine.setup(),
          Slower(machine.setup().trajectories.Find(experiment.trajectory),
                 experiment.slower));
      runs[i][which] = RunOf(machine, excitation, which == 0 ? one : other);
    } catch (const std::exception&) {
      // An experiment that cannot be run is not proposed.
    }
  });
  for (std::size_t i = 0; i < experiments.size(); ++i) {
    const auto& [a, b] = runs[i];
    if (a && b) experiments[i].separation = Separation(machine.setup(), *a, *b);
  }
  const auto best = std::ranges::max_element(experiments, std::less<>(),
                                             &DiscriminatingExperiment::separation);
  if (best == experiments.end() || best->separation <= 0.0) return std::nullopt;
  return *best;
}

}  // namespace mjdiag
