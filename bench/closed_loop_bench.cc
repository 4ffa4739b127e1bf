// What the control callback costs: closed loop over bare mj_step of the same model, the
// same number of steps and the same motion. The two are timed in turn, in short slices,
// so that whatever else the machine does meets both alike; the figure is the median of
// the slices' ratios.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "mjdiag/plugin/runtime/instance.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kTicksPerSlice = 400;

double Seconds(const mjModel& model, mjData& data, int steps) {
  const auto start = Clock::now();
  for (int i = 0; i < steps; ++i) mj_step(&model, &data);
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void ClosedLoopOverBareSteps(benchmark::State& state, bool static_friction) {
  const Machine machine = test::Bonder(
      {std::string("physics.static_friction=") + (static_friction ? "true" : "false")});
  const Setup& setup = machine.setup();
  const Excitation excitation =
      FollowTrajectory(setup, setup.trajectories.Find(setup.trajectories.fallback));
  const StartedPlant started = StartPlant(machine, {});
  const mjModel& model = *started.model;
  const int steps = kTicksPerSlice * setup.rates.substeps;
  std::vector<double> ratios;
  double bare_seconds = 0.0;
  for (auto _ : state) {
    Instance instance(machine, excitation, {});
    const DataPtr closed = MakeData(model);
    const DataPtr bare = MakeData(model);
    mj_copyData(closed.get(), &model, started.data.get());
    Attach(model, *closed, instance);
    for (Eigen::Index tick = 0; tick + kTicksPerSlice <= excitation.samples();
         tick += kTicksPerSlice) {
      // The bare machine starts each slice where the controlled one is, so both solve
      // the same problem.
      mj_copyData(bare.get(), &model, closed.get());
      Detach(model, *bare);
      const double with_control = Seconds(model, *closed, steps);
      const double without = Seconds(model, *bare, steps);
      bare_seconds += without;
      ratios.push_back(with_control / without);
    }
  }
  state.counters["closed_over_bare"] = Median(ratios);
  state.counters["us_per_bare_step"] =
      1e6 * bare_seconds / (static_cast<double>(ratios.size()) * steps);
}

BENCHMARK_CAPTURE(ClosedLoopOverBareSteps, without_friction, false)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);
BENCHMARK_CAPTURE(ClosedLoopOverBareSteps, with_friction, true)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
