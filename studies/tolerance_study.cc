#include "mjdiag/studies/tolerance_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "mjdiag/plugin/design/known_faults.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/answer.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kWindow = 0.05;  // s
constexpr double kBack = 1.1;
constexpr double kDelay = 0.05;  // of somebody who knows [s]
constexpr double kSure = 1e-6;   // sd that he tells
/// Part of the motion after which faults appear.
constexpr double kMidway = 1.0 / 3.0;

VectorXd TrackingError(const Record& record, const AxisSetup& axis) {
  return record.At(axis.name + "_ref").samples - record.At(axis.sensor).samples;
}

/// Mean of the last `window` values.
VectorXd MovingMean(const VectorXd& values, Index window) {
  VectorXd mean(values.size());
  double sum = 0.0;
  for (Index k = 0; k < values.size(); ++k) {
    sum += values[k];
    if (k >= window) sum -= values[k - window];
    mean[k] = sum / static_cast<double>(std::min(k + 1, window));
  }
  return mean;
}

/// Largest value within `reach` of every one.
VectorXd LocalPeak(const VectorXd& values, Index reach) {
  VectorXd peak(values.size());
  for (Index k = 0; k < values.size(); ++k) {
    const Index from = std::max<Index>(0, k - reach);
    const Index to = std::min(values.size(), k + reach + 1);
    peak[k] = values.segment(from, to - from).maxCoeff();
  }
  return peak;
}

double Rms(const VectorXd& error) {
  return std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
}

struct Errors {
  VectorXd healthy, uncorrected, corrected;
};

void Add(const Errors& errors, Index fault, Index window, Index repetition,
         double noise, double tick, ToleratedRun& run) {
  const double healthy = Rms(errors.healthy.tail(repetition));
  run.uncorrected =
      std::max(run.uncorrected, Rms(errors.uncorrected.tail(repetition)) / healthy);
  run.corrected =
      std::max(run.corrected, Rms(errors.corrected.tail(repetition)) / healthy);
  const VectorXd is = MovingMean(errors.corrected.cwiseAbs2(), window);
  const VectorXd was = MovingMean(errors.healthy.cwiseAbs2(), window);
  Index last = fault - 1;
  for (Index k = fault; k < is.size(); ++k) {
    if (is[k] > kBack * kBack * was[k]) last = k;
  }
  const double back = last + 1 == is.size()
                          ? std::numeric_limits<double>::infinity()
                          : static_cast<double>(last + 1 - fault) * tick;
  run.recovery = std::max(run.recovery, back);
  if (!(noise > 0.0)) return;
  const VectorXd largest = LocalPeak(
      errors.healthy.cwiseAbs().cwiseMax(errors.uncorrected.cwiseAbs()), window);
  const VectorXd more = errors.corrected.cwiseAbs() - largest;
  run.bump = std::max(run.bump, more.tail(more.size() - fault).maxCoeff() / noise);
}

Index RepetitionOf(const Machine& machine, Index samples) {
  const Trajectories& all = machine.setup().trajectories;
  const double period = all.Find(all.fallback).period;
  const auto ticks = static_cast<Index>(std::lround(period / machine.rates().tick()));
  return ticks > 0 && ticks < samples ? ticks : samples / 4;
}

double FirstCorrection(const Reconfiguration& reconfiguration) {
  Index first = std::numeric_limits<Index>::max();
  for (const RemedyState& state : reconfiguration.states()) {
    if (state.since >= 0) first = std::min(first, state.since);
  }
  return first == std::numeric_limits<Index>::max()
             ? std::numeric_limits<double>::infinity()
             : static_cast<double>(first) * reconfiguration.options().sample_time;
}

/// "-" of what did not come.
Cell TimeCell(double seconds) {
  return std::isfinite(seconds) ? Cell(seconds) : Cell("-");
}

std::string NamesOf(const std::vector<SizedFault>& faults) {
  std::string names;
  for (const SizedFault& fault : faults) {
    names += (names.empty() ? "" : ", ") + fault.name + " = " + Cell(fault.value).text;
  }
  return names;
}

/// Values that are tried of a fault parameter, between and a little beyond those that
/// are corrected.
std::vector<double> ValuesOf(const FaultRemedy& remedy) {
  if (!remedy.tones.empty()) return {0.1, 1.0, 2.0};
  if (!remedy.drives.empty()) return {0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.25, 1.5};
  return {1.0 + remedy.least, 0.5 * (2.0 + remedy.least), 0.5 * (2.0 + remedy.most),
          1.0 + remedy.most};
}

StudyTable MarginTable(const Machine& machine, const TolerancePlan& plan) {
  StudyTable table{"Gain margins",
                   {"axis", "least gain", "most gain"},
                   {},
                   {"Largest modulus of an eigenvalue of the closed loop: healthy " +
                    std::to_string(plan.margins.healthy_radius) +
                    ", over the range of the faults and within the margins " +
                    std::to_string(plan.margins.largest_radius) + "."}};
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    table.rows.push_back({machine.setup().control.axes[i].name, plan.axes[i].least_gain,
                          plan.axes[i].most_gain});
  }
  return table;
}

/// Loop gains of every axis when that deviation is acted on.
VectorXd GainsFor(const TolerancePlan& plan, const FaultRemedy& remedy,
                  double deviation) {
  VectorXd gains = VectorXd::Ones(static_cast<Index>(plan.axes.size()));
  const double acting = std::clamp(deviation, remedy.least, remedy.most);
  for (const Index drive : remedy.drives) {
    const RemediedAxis& axis = plan.axes[static_cast<std::size_t>(drive)];
    gains[drive] = std::clamp(1.0 / (1.0 + acting), axis.least_gain, axis.most_gain);
  }
  return gains;
}

StudyTable SweepTable(const LoadedPlan& loaded, const TolerancePlan& plan, double time,
                      const StudyOptions& options) {
  const Machine& machine = loaded.machine;
  const FaultFamily family = MakeFaultFamily(machine);
  const auto parameters = static_cast<Index>(family.parameters.size());
  const VectorXd as_made = VectorXd::Ones(static_cast<Index>(plan.axes.size()));
  StudyTable table{
      "Every fault over its range, linear plant",
      {"fault", "value", "eigenvalue uncorrected", "corrected", "corrected, fault gone",
       "error uncorrected", "corrected"},
      {},
      {"Largest modulus of an eigenvalue of the closed loop, with the fault, "
       "corrected, "
       "and with the correction when the fault has gone.",
       "Tracking error of the last repetition over the healthy one, rms of the worst "
       "axis, in runs in which the fault appears midway and is known."}};
  for (std::size_t i = 0; i < plan.remedies.size(); ++i) {
    const FaultRemedy& remedy = plan.remedies[i];
    for (const double value : ValuesOf(remedy)) {
      const auto at = static_cast<Index>(i);
      VectorXd values = VectorXd::Ones(parameters);
      if (at < parameters) values[at] = value;
      const VectorXd gains = GainsFor(plan, remedy, value - 1.0);
      const ToleratedRun run =
          TryTolerance(machine, plan, {{remedy.fault, value}}, time, Teller::kKnown,
                       true, loaded.plan.seed);
      table.rows.push_back(
          {remedy.fault, value, LoopRadius(machine, family, values, as_made),
           LoopRadius(machine, family, values, gains),
           LoopRadius(machine, family, VectorXd::Ones(parameters), gains),
           run.uncorrected, run.corrected});
    }
    if (options.progress) {
      options.progress(0.5 * static_cast<double>(i + 1) /
                       static_cast<double>(plan.remedies.size()));
    }
  }
  return table;
}

/// What is wrong, one after another, at the points of the plan.
std::vector<std::vector<SizedFault>> CasesOf(const StudyPlan& plan) {
  std::vector<std::vector<SizedFault>> cases;
  std::vector<std::string> names;
  for (const PointRuns& point : RunsByPoint(RunPlanner(plan))) {
    std::vector<SizedFault> faults = FaultsOf(point.front());
    const std::string name = NamesOf(faults);
    if (std::ranges::find(names, name) != names.end()) continue;
    names.push_back(name);
    cases.push_back(std::move(faults));
  }
  return cases;
}

StudyTable MidwayTable(const LoadedPlan& loaded, const TolerancePlan& plan, double time,
                       const StudyOptions& options) {
  const Machine& machine = loaded.machine;
  StudyTable table{
      "Faults that appear midway",
      {"plant", "estimates", "faults", "error uncorrected", "corrected",
       "first correction [s]", "within 1.1 after [s]", "bump [noise sd]"},
      {},
      {"Errors: tracking error of the last repetition over the healthy one, rms of the "
       "worst axis. Times count from the fault; \"-\" did not come.",
       "Bump: how much larger than with and without the fault the tracking error is at "
       "any time, in standard deviations of the sensor noise; below 0 it never is."}};
  const std::vector<std::vector<SizedFault>> cases = CasesOf(loaded.plan);
  int done = 0;
  for (const bool linear : {true, false}) {
    for (const Teller teller : {Teller::kKnown, Teller::kTwin}) {
      for (const std::vector<SizedFault>& faults : cases) {
        const ToleratedRun run =
            TryTolerance(machine, plan, faults, time, teller, linear, loaded.plan.seed);
        table.rows.push_back({linear ? "linear" : "nonlinear",
                              teller == Teller::kKnown ? "known" : "twin",
                              NamesOf(faults), run.uncorrected, run.corrected,
                              TimeCell(run.since), TimeCell(run.recovery), run.bump});
        if (options.progress) {
          options.progress(0.5 + 0.125 * ++done / static_cast<double>(cases.size()));
        }
      }
    }
  }
  return table;
}

}  // namespace

ToleratedRun TryTolerance(const Machine& machine, const TolerancePlan& plan,
                          const std::vector<SizedFault>& faults, double time,
                          Teller teller, bool linear, std::uint64_t seed) {
  const Excitation motion = DefaultMotion(machine.setup());
  RunOptions options;
  options.seed = seed;
  const auto run = [&] {
    return linear ? SimulateLinear(machine, motion, options)
                  : Simulate(machine, motion, options);
  };
  const Record healthy = run();
  for (const SizedFault& fault : faults) {
    options.late_faults.push_back({{fault.name, fault.value}, time});
  }
  const Record uncorrected = run();

  std::optional<DiagnosisRecording> recording;
  std::optional<MonitorObserver> watched;
  std::optional<FaultTolerance> tolerance;
  std::optional<Reconfiguration> told;
  std::unique_ptr<TickObserver> teller_of;
  Reconfiguration* reconfiguration = nullptr;
  if (teller == Teller::kTwin) {
    recording.emplace(DesignFilters(machine), motion.samples());
    if (auto twin = MakeTwinEstimator(machine, linear)) {
      recording->monitor.Follow(std::move(twin));
    }
    watched.emplace(*recording);
    tolerance.emplace(plan, recording->monitor, *watched);
    options.observer = &*tolerance;
    reconfiguration = &tolerance->reconfiguration();
  } else {
    told.emplace(plan.axes, plan.remedies, plan.options);
    reconfiguration = &*told;
    teller_of = std::make_unique<KnownFaults>(*told, machine.setup(),
                                              options.late_faults, kDelay, kSure);
    options.observer = teller_of.get();
  }
  options.reconfiguration = reconfiguration;
  const Record corrected = run();

  ToleratedRun result;
  result.bump = -std::numeric_limits<double>::infinity();
  result.since = FirstCorrection(*reconfiguration) - time;
  const double tick = machine.rates().tick();
  const auto fault = static_cast<Index>(std::lround(time / tick));
  const auto window = static_cast<Index>(std::lround(kWindow / tick));
  if (fault < 0 || fault + window >= healthy.samples()) {
    throw InputError("tolerance", "the fault appears too late in the run",
                     "an earlier time or a longer motion");
  }
  for (const AxisSetup& axis : machine.setup().control.axes) {
    Add({TrackingError(healthy, axis), TrackingError(uncorrected, axis),
         TrackingError(corrected, axis)},
        fault, window, RepetitionOf(machine, healthy.samples()),
        machine.channels().Sensor(axis.sensor).noise_sd, tick, result);
  }
  return result;
}

std::vector<StudyTable> AnswerTo(const AskTolerance&, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const Machine& machine = loaded.machine;
  const TolerancePlan plan = PlanTolerance(machine);
  const double time = kMidway *
                      static_cast<double>(DefaultMotion(machine.setup()).samples()) *
                      machine.rates().tick();
  return {MarginTable(machine, plan), SweepTable(loaded, plan, time, options),
          MidwayTable(loaded, plan, time, options)};
}

}  // namespace mjdiag
