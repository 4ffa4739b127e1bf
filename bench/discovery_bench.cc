// What a discovery costs, in runs: the time from a record to causes over the time of
// one nominal replay of that record, and the largest memory of the process. A run in
// real time is the machine's own: 2.5 s of the AB383, 24.8 s of EMPS. The effects that
// are looked for are put in here, so that no measured data is needed.
//
// Counters: seconds (for people; no test reads it), runs (seconds over one replay),
// MiB (largest resident set), found (1 if the cause was named).

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <chrono>
#include <string>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double LargestMiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void DiscoverIn(benchmark::State& state, const std::string& folder,
                const std::vector<std::string>& effects) {
  const Machine machine(ReadSetup(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/" + folder));
  const Trajectories& motions = machine.setup().trajectories;
  const Record measured =
      Simulate(machine.With(test::With(effects)),
               FollowTrajectory(machine.setup(), motions.Find(motions.fallback)), {});
  DiscoverOptions options;
  for (auto _ : state) {
    const DiscoveryProblem problem =
        PoseProblem(machine, measured, options.train_share, options.bandwidth);
    auto start = Clock::now();
    benchmark::DoNotOptimize(problem.Residual({}));
    const double replay = Since(start);
    start = Clock::now();
    const Discovery discovery = Discover(machine, measured, nullptr, options);
    const double seconds = Since(start);
    state.counters["seconds"] = seconds;
    state.counters["runs"] = seconds / replay;
    state.counters["MiB"] = LargestMiB();
    state.counters["found"] = discovery.causes.size() == effects.size() ? 1.0 : 0.0;
  }
}

BENCHMARK_CAPTURE(DiscoverIn, ab383, "ab383",
                  {"asymmetric_viscous_friction@Y:positive=0.0015,negative=0.0037"})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(DiscoverIn, emps, "emps",
                  {"coulomb_friction@load:force=20", "force_offset@load:force=-3.2"})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
