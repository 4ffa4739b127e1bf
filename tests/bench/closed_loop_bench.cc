// What the control callback costs: closed loop over bare mj_step of the same model, the
// same number of steps and the same motion, to the last bit: the bare machine gets the
// commands that the closed loop gave, tick by tick, as whoever steps a model sets them. The
// two are timed in turn, in short slices, the one that goes first changing from slice to
// slice, in time of the thread; the figure is the median of the slices' ratios.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "bench/timing.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

constexpr int kTicksPerSlice = 400;

void ClosedLoopOverBareSteps(benchmark::State& state, bool static_friction) {
  const Machine machine = test::Bonder(
      {std::string("physics.static_friction=") + (static_friction ? "true" : "false")});
  const Setup& setup = machine.setup();
  const Excitation excitation =
      FollowTrajectory(setup, setup.trajectories.Find(setup.trajectories.fallback));
  const Eigen::MatrixXd commands = SamplesOf(Simulate(machine, excitation, {}),
                                             ChannelsOf(setup.channels.actuators));
  const std::vector<int>& actuators = machine.actuator_addresses();
  const StartedPlant started = StartPlant(machine, {});
  const mjModel& model = *started.model;
  const int substeps = setup.rates.substeps;
  std::vector<double> ratios;
  double bare_seconds = 0.0;
  for (auto _ : state) {
    Instance instance(machine, excitation, {});
    const DataPtr closed = MakeData(model);
    const DataPtr bare = MakeData(model);
    mj_copyData(closed.get(), &model, started.data.get());
    mj_copyData(bare.get(), &model, started.data.get());
    Attach(model, *closed, instance);
    bool bare_first = false;
    for (Eigen::Index tick = 0; tick + kTicksPerSlice <= commands.cols();
         tick += kTicksPerSlice) {
      const auto time_closed = [&] {
        return Seconds(ThreadTime, [&] {
          for (int i = 0; i < kTicksPerSlice * substeps; ++i) {
            mj_step(&model, closed.get());
          }
        });
      };
      const auto time_bare = [&] {
        return Seconds(ThreadTime, [&] {
          for (Eigen::Index k = tick; k < tick + kTicksPerSlice; ++k) {
            for (std::size_t i = 0; i < actuators.size(); ++i) {
              bare->ctrl[actuators[i]] = commands(static_cast<Eigen::Index>(i), k);
            }
            for (int step = 0; step < substeps; ++step) mj_step(&model, bare.get());
          }
        });
      };
      const double before = bare_first ? time_bare() : 0.0;
      const double with_control = time_closed();
      const double without = bare_first ? before : time_bare();
      bare_first = !bare_first;
      bare_seconds += without;
      ratios.push_back(with_control / without);
    }
    if (!std::equal(closed->qpos, closed->qpos + model.nq, bare->qpos)) {
      state.SkipWithError("the motions differ");
    }
  }
  state.counters["closed_over_bare"] = Median(ratios);
  state.counters["us_per_bare_step"] =
      1e6 * bare_seconds /
      (static_cast<double>(ratios.size()) * kTicksPerSlice * substeps);
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
