// What a diagnosis costs: a closed loop with a monitor in its control callback over the
// same loop without, and the time of synthesis. The two loops run the same motion and
// are timed in turn, in short slices, in time of the thread, the one that goes first
// changing from slice to slice; the figure is the median of the slices' ratios. Synthesis
// is a time against a limit in the same unit: each part is the median of its repetitions.
//
// A twin is timed on the record of a run, beside a closed loop and bare steps of the same
// machine, all in time of the thread: while it goes back to learn (the first two
// seconds), and when it follows. So are single ticks of it, for their quantiles.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/timing.h"
#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

constexpr int kTicksPerSlice = 400;

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
    return Seconds(ThreadTime, [&] {
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

/// Readings and commands of a run that is long enough for a twin to follow.
struct WatchedRun {
  Eigen::MatrixXd outputs, inputs;
};

constexpr Eigen::Index kLearns = 16000;   // ticks in which it goes back
constexpr Eigen::Index kFollows = 34000;  // from there on it does not any more

WatchedRun LongRun(const Machine& machine, bool linear) {
  const Excitation motion = DefaultMotion(machine.setup());
  const Record record =
      linear ? SimulateLinear(machine, motion, {}) : Simulate(machine, motion, {});
  return {SamplesOf(record, ChannelsOf(machine.setup().channels.sensors)),
          SamplesOf(record, ChannelsOf(machine.setup().channels.actuators))};
}

/// A monitor as it watches a machine that it knows the limits of.
std::unique_ptr<DiagnosisMonitor> Watch(const Machine& machine, bool linear) {
  auto monitor = std::make_unique<DiagnosisMonitor>(DesignFilters(machine));
  monitor->Follow(MakeTwinEstimator(machine, linear));
  return monitor;
}

void Feed(DiagnosisMonitor& monitor, const WatchedRun& run, Eigen::Index tick) {
  const auto span = [](const Eigen::MatrixXd& samples, Eigen::Index k) {
    return std::span<const double>(samples.col(k).data(),
                                   static_cast<std::size_t>(samples.rows()));
  };
  monitor.Add(span(run.outputs, tick), span(run.inputs, tick));
}

Machine LongBonder() { return test::Bonder({"trajectories.multi.duration=5.25"}); }

/// The diagnosis of a tick over the closed loop's tick without it, and over its bare
/// steps.
void TwinOverTick(benchmark::State& state, bool linear) {
  const Machine machine = LongBonder();
  const int steps = kTicksPerSlice * machine.rates().substeps;
  const WatchedRun run = LongRun(machine, linear);
  for (auto _ : state) {
    const std::unique_ptr<DiagnosisMonitor> monitor = Watch(machine, linear);
    StartedPlant closed = StartPlant(machine, {});
    Instance instance(machine, DefaultMotion(machine.setup()), {});
    Attach(*closed.model, *closed.data, instance);
    const DataPtr bare = MakeData(*closed.model);
    const auto time_steps = [&](mjData& data) {
      return Seconds(ThreadTime, [&] {
        for (int i = 0; i < steps; ++i) mj_step(closed.model.get(), &data);
      });
    };
    std::vector<double> closed_ratios[2], bare_ratios[2];
    for (Eigen::Index tick = 0; tick + kTicksPerSlice <= run.outputs.cols();
         tick += kTicksPerSlice) {
      // Bare steps begin where the controlled machine is.
      mj_copyData(bare.get(), closed.model.get(), closed.data.get());
      Detach(*closed.model, *bare);
      const double of_steps = time_steps(*bare);
      const double of_loop = time_steps(*closed.data);
      const double of_twin = Seconds(ThreadTime, [&] {
        for (int k = 0; k < kTicksPerSlice; ++k) Feed(*monitor, run, tick + k);
      });
      if (tick >= kLearns && tick < kFollows) continue;
      const int follows = tick >= kFollows ? 1 : 0;
      closed_ratios[follows].push_back(of_twin / of_loop);
      bare_ratios[follows].push_back(of_twin / of_steps);
    }
    state.counters["learns_over_loop"] = Median(closed_ratios[0]);
    state.counters["learns_over_bare"] = Median(bare_ratios[0]);
    state.counters["follows_over_loop"] = Median(closed_ratios[1]);
    state.counters["follows_over_bare"] = Median(bare_ratios[1]);
  }
}

BENCHMARK_CAPTURE(TwinOverTick, linear, true)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(TwinOverTick, nonlinear, false)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

double Quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::llround(
                                       share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// [us] of single ticks of the diagnosis.
void TwinTicks(benchmark::State& state, bool linear) {
  const Machine machine = LongBonder();
  const WatchedRun run = LongRun(machine, linear);
  for (auto _ : state) {
    const std::unique_ptr<DiagnosisMonitor> monitor = Watch(machine, linear);
    std::vector<double> learns, follows;
    for (Eigen::Index tick = 0; tick < run.outputs.cols(); ++tick) {
      const double us = 1e6 * Seconds(ThreadTime, [&] { Feed(*monitor, run, tick); });
      if (tick < kLearns) learns.push_back(us);
      if (tick >= kFollows) follows.push_back(us);
    }
    const auto count = [&state](const std::string& name, std::vector<double>& times) {
      state.counters[name + "_p50"] = Quantile(times, 0.5);
      state.counters[name + "_p99"] = Quantile(times, 0.99);
      state.counters[name + "_p99.9"] = Quantile(times, 0.999);
      state.counters[name + "_max"] = Quantile(times, 1.0);
    };
    count("learns", learns);
    count("follows", follows);
  }
}

BENCHMARK_CAPTURE(TwinTicks, linear, true)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(TwinTicks, nonlinear, false)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

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
        Seconds(ClockTime, [&] { perturbed = MakeFaultFamily(machine).Perturbed(); }));
    synthesise.push_back(Seconds(ClockTime, [&] {
      const ResidualSpace space = MakeResidualSpace(healthy, options);
      const Eigen::Index size = space.relations.front().rows();
      benchmark::DoNotOptimize(SynthesiseBank(
          space, Eigen::MatrixXd::Identity(size, size), perturbed, options));
    }));
    design.push_back(
        Seconds(ClockTime, [&] { benchmark::DoNotOptimize(DesignFilters(machine)); }));
  }
  state.counters["ms_linearisations"] = 1e3 * Median(linearise);
  state.counters["ms_bank"] = 1e3 * Median(synthesise);
  state.counters["ms_design"] = 1e3 * Median(design);
}

BENCHMARK(Synthesis)->Unit(benchmark::kMillisecond)->Iterations(11);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
