// Runs a second of a plan, beside the bare simulation loop of the same runs: all that a
// study does beside simulating (drawing, compressing and journaling, the data set) costs
// the difference. Both use all cores. They take turns, a few dozen runs each, so that
// whatever else the machine does meets both alike; the figure is the median of the ratios.

#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bench/timing.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/freed_memory.h"
#include "mjdiag/studies/dataset/plan_run.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

std::string PlanText(int runs, int seed) {
  return R"(schema = "mjdiag.plan/1"
name = "bench"
setup = "mjcf/ab383"
linear = true
method = "sobol"
points = )" +
         std::to_string(runs) + "\nseed = " + std::to_string(seed) + R"(
[keep]
records = ["x", "y", "z", "u_x", "u_y", "u_z"]
every = 8
precision = "single"
[[axis]]
fault = "zeta_x"
from = 1.001
to = 2
scale = "log"
[[axis]]
fault = "eta_x"
from = 0.999
to = 0.9
scale = "log"
)";
}

/// The simulations of a plan and nothing else.
void SimulateAll(const LoadedPlan& plan) {
  const RunMaker maker(plan);
  const RunPlanner planner(plan.plan);
  std::vector<PlannedRun> runs;
  for (std::int64_t i = 0; i < planner.runs(); ++i) runs.push_back(planner.Run(i));
  ParallelFor(static_cast<int>(runs.size()), [&](int i) {
    benchmark::DoNotOptimize(maker.Simulate(runs[static_cast<std::size_t>(i)]));
  });
}

void StudyOverBareLoop(benchmark::State& state) {
  constexpr int kRuns = 80;
  KeepFreedMemory();  // as the command does
  const test::TemporaryFolder folder;
  std::vector<double> ratios;
  double study_seconds = 0.0;
  int turn = 0;
  for (auto _ : state) {
    const LoadedPlan plan = ParsePlan(PlanText(kRuns, ++turn), MJDIAG_SOURCE_DIR);
    const double bare_seconds = Seconds(ClockTime, [&] { SimulateAll(plan); });
    const double seconds =
        Seconds(ClockTime, [&] { RunPlan(plan, {folder / std::to_string(turn)}); });
    study_seconds += seconds;
    ratios.push_back(bare_seconds / seconds);
    std::filesystem::remove_all(folder / std::to_string(turn));
  }
  state.counters["runs/s over bare"] = Median(ratios);
  state.counters["runs/s"] = turn * kRuns / study_seconds;
}

BENCHMARK(StudyOverBareLoop)->Iterations(3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
