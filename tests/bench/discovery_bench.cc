// What a discovery costs, in runs: the processor time from a record to causes over that of
// one nominal replay of that record, and the largest memory of the process. A run in
// real time is the machine's own: 2.5 s of the AB383, or the first half second of it,
// 24.8 s of EMPS. The effects that are looked for are put in here, so that no measured
// data is needed.
//
// Counters: seconds (for people; no test reads it), work (processor time over one replay,
// which does not know how many cores share it and how busy they are), MiB (largest resident
// set), found (1 if the cause was named).

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <string>
#include <vector>

#include "bench/timing.h"
#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

double LargestMiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// Processor time of a nominal replay: the median of some.
double ReplayTime(const Machine& machine, const Record& measured) {
  const Excitation replay = Replay(machine.setup(), measured);
  std::vector<double> times(5);
  for (double& time : times) {
    time = Seconds(ProcessTime,
                   [&] { benchmark::DoNotOptimize(Simulate(machine, replay, {})); });
  }
  return Median(times);
}

/// @param share  of the motion
void DiscoverIn(benchmark::State& state, const std::string& folder, double share,
                const std::vector<std::string>& effects) {
  const Machine machine(ReadSetup(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/" + folder));
  const Trajectories& motions = machine.setup().trajectories;
  Trajectory motion = motions.Find(motions.fallback);
  motion.duration *= share;
  const Record measured = Simulate(machine.With(test::With(effects)),
                                   FollowTrajectory(machine.setup(), motion), {});
  DiscoverOptions options;
  for (auto _ : state) {
    const double replay = ReplayTime(machine, measured);
    const double worked = ProcessTime();
    const double start = ClockTime();
    const Discovery discovery = Discover(machine, measured, nullptr, options);
    state.counters["seconds"] = ClockTime() - start;
    state.counters["work"] = (ProcessTime() - worked) / replay;
    state.counters["MiB"] = LargestMiB();
    state.counters["found"] = discovery.causes.size() == effects.size() ? 1.0 : 0.0;
  }
}

const std::vector<std::string> kOfTheBonder = {
    "asymmetric_viscous_friction@Y:positive=0.0015,negative=0.0037"};
BENCHMARK_CAPTURE(DiscoverIn, ab383, "ab383", 1.0, kOfTheBonder)
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(DiscoverIn, ab383_half_second, "ab383", 0.2, kOfTheBonder)
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(DiscoverIn, emps, "emps", 1.0,
                  {"coulomb_friction@load:force=20", "force_offset@load:force=-3.2"})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
