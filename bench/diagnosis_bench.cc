// What a diagnosis costs: a closed loop with a monitor in its control callback over the
// same loop without, and the time of synthesis. The two loops run the same motion and
// are timed in turn, in short slices, the one that goes first changing from slice to
// slice, so that whatever else the machine does meets both alike; the figure is the
// median of the slices' ratios. Synthesis is a time against a limit in the same unit:
// each part is the median of its repetitions.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kTicksPerSlice = 400;

template <typename Action>
double Seconds(const Action& action) {
  const auto start = Clock::now();
  action();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

Machine Bonder(bool static_friction) {
  return test::Bonder(
      {std::string("physics.static_friction=") + (static_friction ? "true" : "false")});
}

/// A closed loop that stands at its first tick.
class Loop {
 public:
  Loop(const Machine& machine, TickObserver* observer)
      : plant_(StartPlant(machine, {})),
        instance_(machine, DefaultMotion(machine.setup()), Options(observer)) {
    Attach(*plant_.model, *plant_.data, instance_);
  }
  double TimeSteps(int steps) {
    return Seconds([&] {
      for (int i = 0; i < steps; ++i) mj_step(plant_.model.get(), plant_.data.get());
    });
  }

 private:
  static RunOptions Options(TickObserver* observer) {
    RunOptions options;
    options.observer = observer;
    return options;
  }
  StartedPlant plant_;
  Instance instance_;
};

void MonitoredOverPlainLoop(benchmark::State& state, bool static_friction) {
  const Machine machine = Bonder(static_friction);
  const Eigen::Index ticks = DefaultMotion(machine.setup()).samples();
  DiagnosisDesign design = DesignFilters(machine);
  NominalRuns nominal;
  nominal.linear = true;
  design.limits = CalibrateLimits(design, machine, nominal);
  const int steps = kTicksPerSlice * machine.rates().substeps;
  std::vector<double> ratios;
  double added = 0.0;
  for (auto _ : state) {
    DiagnosisRecording recording(design, ticks);
    MonitorObserver observer(recording);
    Loop plain(machine, nullptr);
    Loop monitored(machine, &observer);
    bool plain_first = false;
    for (Eigen::Index tick = 0; tick + kTicksPerSlice <= ticks;
         tick += kTicksPerSlice) {
      const double before = plain_first ? plain.TimeSteps(steps) : 0.0;
      const double with = monitored.TimeSteps(steps);
      const double without = plain_first ? before : plain.TimeSteps(steps);
      plain_first = !plain_first;
      added += with - without;
      ratios.push_back(with / without);
    }
  }
  state.counters["monitored_over_plain"] = Median(ratios);
  state.counters["us_added_a_tick"] =
      1e6 * added / (static_cast<double>(ratios.size()) * kTicksPerSlice);
}

BENCHMARK_CAPTURE(MonitoredOverPlainLoop, with_friction, true)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);
BENCHMARK_CAPTURE(MonitoredOverPlainLoop, without_friction, false)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);

void Synthesis(benchmark::State& state) {
  const Machine machine = Bonder(true);
  const MechanicalModel& healthy = machine.linear();
  const SynthesisOptions options = SynthesisOf(machine);
  std::vector<PerturbedModels> perturbed;
  std::vector<double> linearise;
  std::vector<double> synthesise;
  std::vector<double> design;
  for (auto _ : state) {
    linearise.push_back(
        Seconds([&] { perturbed = MakeFaultFamily(machine).Perturbed(); }));
    synthesise.push_back(Seconds([&] {
      const ResidualSpace space = MakeResidualSpace(healthy, options);
      const Eigen::Index size = space.relations.front().rows();
      benchmark::DoNotOptimize(SynthesiseBank(
          space, Eigen::MatrixXd::Identity(size, size), perturbed, options));
    }));
    design.push_back(
        Seconds([&] { benchmark::DoNotOptimize(DesignFilters(machine)); }));
  }
  state.counters["ms_linearisations"] = 1e3 * Median(linearise);
  state.counters["ms_bank"] = 1e3 * Median(synthesise);
  state.counters["ms_design"] = 1e3 * Median(design);
}

BENCHMARK(Synthesis)->Unit(benchmark::kMillisecond)->Iterations(11);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
