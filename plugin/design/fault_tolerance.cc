#include "mjdiag/plugin/design/fault_tolerance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/diagnosis/twin/naming.h"
#include "mjdiag/plugin/design/reference_forces.h"
#include "mjdiag/plugin/effects/kind.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPersistence = 2.0;  // time constants of the loop
constexpr double kSlowness = 3.0;
/// A thousandth of a command is less than what the feedforward of a healthy machine
/// lacks, and a twin that has not settled yet is wrong by less than that.
constexpr double kLeast = 1e-3;
constexpr double kPatience = 10.0;
/// By chance the NIS is not above it.
constexpr double kExplained = 2.0;
/// Part of the largest force along a derivative below which it is rounding.
constexpr double kNoForce = 1e-9;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<RemediedAxis> AxesOf(const Machine& machine, const GainMargins& margins) {
  const Setup& setup = machine.setup();
  const VectorXd rest =
      SensorReadings(machine.channels(), machine.plant(), machine.rest());
  std::vector<RemediedAxis> axes;
  for (std::size_t i = 0; i < setup.control.axes.size(); ++i) {
    const AxisSetup& axis = setup.control.axes[i];
    const auto at = static_cast<Index>(i);
    axes.push_back({axis.drive_gain, rest[setup.channels.SensorIndex(axis.sensor)],
                    margins.least[at], margins.most[at]});
  }
  return axes;
}

/// Axes whose motor is one of the elements.
std::vector<Index> DrivesOf(const Machine& machine, const FaultParameter& parameter) {
  const Setup& setup = machine.setup();
  std::vector<Index> drives;
  for (std::size_t i = 0; i < setup.control.axes.size(); ++i) {
    const auto channel = static_cast<std::size_t>(
        setup.channels.ActuatorIndex(setup.control.axes[i].actuator));
    const int actuator = machine.actuator_addresses()[channel];
    if (std::find(parameter.elements.begin(), parameter.elements.end(), actuator) !=
        parameter.elements.end()) {
      drives.push_back(static_cast<Index>(i));
    }
  }
  return drives;
}

/// What a unit of the law adds to the forces; nothing where that is rounding.
MatrixXd ChangeOf(const MatrixXd& worn, const MatrixXd& healthy) {
  const double least =
      kNoForce * std::max(worn.cwiseAbs().maxCoeff(), healthy.cwiseAbs().maxCoeff());
  const MatrixXd change = worn - healthy;
  if (!(change.cwiseAbs().maxCoeff() > least)) return {};
  return (change.array().abs() > least).select(change, 0.0);
}

ReferenceForces ForcesOf(const Machine& machine, const FaultFamily& family, Index place,
                         double value) {
  VectorXd values = VectorXd::Ones(static_cast<Index>(family.parameters.size()));
  const auto healthy = ReferenceForcesOf(family.model_at(values), machine.setup());
  values[place] = value;
  const auto worn = ReferenceForcesOf(family.model_at(values), machine.setup());
  const auto change = [&](std::size_t n) { return ChangeOf(worn[n], healthy[n]); };
  return {change(0), change(1), change(2), change(4)};
}

FaultRemedy RemedyOf(const Machine& machine, const FaultFamily& family,
                     const FaultParameter& parameter, Index place, ControlMode mode,
                     const GainMargins& margins, const FaultRange& range) {
  FaultRemedy remedy;
  remedy.fault = parameter.name;
  if (parameter.kind == ModelParameterKind::kGear) {
    remedy.drives = DrivesOf(machine, parameter);
    double least = 1.0;
    double most = 1.0;
    for (const Index drive : remedy.drives) {
      least = std::min(least, 1.0 / margins.most[drive]);
      most = std::max(most, 1.0 / margins.least[drive]);
    }
    remedy.least = least - 1.0;
    remedy.most = most - 1.0;
    return remedy;
  }
  const Kind kind = KindOf(parameter.kind);
  if (kind != Kind::kCompliance && kind != Kind::kViscousFriction &&
      kind != Kind::kInertia) {
    // Dry friction jumps, and a drive that feeds back makes no force of a command alone.
    remedy.least = remedy.most = 0.0;
    return remedy;
  }
  // Masses, too, resist in proportion to what they are.
  const bool damper = kind != Kind::kCompliance;
  remedy.least = (damper ? range.least_damping : range.least_stiffness) - 1.0;
  remedy.most = (damper ? range.most_damping : range.most_stiffness) - 1.0;
  if (mode == ControlMode::kFeedback) return remedy;
  // Where a unit of the law is 1.
  remedy.law = damper ? ForceLaw::kProportional : ForceLaw::kCompliance;
  remedy.forces = ForcesOf(machine, family, place, damper ? 2.0 : 0.5);
  return remedy;
}

FaultRemedy RemedyOf(const Setup& setup, const Multisine& source) {
  FaultRemedy remedy;
  remedy.fault = source.name;
  remedy.least = 0.0;
  remedy.most = std::numeric_limits<double>::infinity();
  VectorXd amplitude(static_cast<Index>(setup.control.axes.size()));
  for (Index i = 0; i < amplitude.size(); ++i) {
    const AxisSetup& axis = setup.control.axes[static_cast<std::size_t>(i)];
    amplitude[i] = source.amplitude[setup.channels.ActuatorIndex(axis.actuator)];
  }
  for (const double frequency : source.frequencies) {
    remedy.tones.push_back({frequency, amplitude});
  }
  return remedy;
}

std::string ActionOf(const FaultRemedy& remedy, const Setup& setup) {
  if (!remedy.tones.empty()) return "tones cancelled";
  if (remedy.drives.empty()) return "feedforward";
  std::string axes;
  for (const Index drive : remedy.drives) {
    axes += (axes.empty() ? "" : ", ") +
            setup.control.axes[static_cast<std::size_t>(drive)].name;
  }
  return "drive gain of " + axes;
}

}  // namespace

TolerancePlan PlanTolerance(const Machine& machine, ControlMode mode) {
  const Setup& setup = machine.setup();
  if (setup.control.axes.empty()) {
    throw InputError("tolerance", "'" + setup.name + "' has no controllers",
                     "a setup with [axes]");
  }
  const FaultFamily family = MakeFaultFamily(machine);
  if (family.Names().empty()) {
    throw InputError("tolerance", "nothing of '" + setup.name + "' may wear",
                     "a plant with fault parameters, or [disturbances]");
  }
  const FaultRange range;
  TolerancePlan plan;
  plan.margins = FindGainMargins(machine, family, range);
  plan.axes = AxesOf(machine, plan.margins);
  Index place = 0;
  for (const FaultParameter& parameter : FaultParameters(machine.plant())) {
    plan.remedies.push_back(
        RemedyOf(machine, family, parameter, place++, mode, plan.margins, range));
  }
  for (const Multisine& source : family.disturbances) {
    plan.remedies.push_back(RemedyOf(setup, source));
  }
  const double loop = plan.margins.time_constant;
  plan.options = {.sample_time = setup.rates.tick(),
                  // As NameFaults: what a healthy machine shows with that probability.
                  .sigmas = TwoSidedNormalQuantile(
                      kFalseFault / static_cast<double>(plan.remedies.size())),
                  .least = kLeast,
                  .time_constant = kSlowness * loop,
                  .persistence = kPersistence * loop,
                  .patience = kPatience * loop};
  return plan;
}

void ReadEstimates(const DiagnosisMonitor& monitor,
                   FaultEstimates& estimates) noexcept {
  const TwinEstimator* twin = monitor.twin();
  if (twin == nullptr || !twin->estimator().began()) return;
  const PredictionErrorEstimator& estimator = twin->estimator();
  const double nis = estimator.recent_nis();
  // A run that no faults explain tells of none (TwinEstimator::Read), and a twin that is
  // catching up with its machine does not know yet.
  if (!(nis < kLargestNis) || !estimator.current()) {
    estimates.sd.setConstant(kNone);
    return;
  }
  estimates.deviation = monitor.estimate();
  estimates.sd = monitor.estimate_sd();
  if (nis > kExplained) estimates.sd *= std::sqrt(nis);
  Index tone = 0;
  for (const TwinFault& fault : twin->faults()) {
    if (fault.frequencies.empty()) continue;
    twin->ReadTones(fault, estimates.tones.segment(tone, 2 * fault.tones()));
    tone += 2 * fault.tones();
  }
}

FaultTolerance::FaultTolerance(const TolerancePlan& plan,
                               const DiagnosisMonitor& monitor, TickObserver& diagnosis)
    : monitor_(monitor),
      diagnosis_(diagnosis),
      reconfiguration_(plan.axes, plan.remedies, plan.options),
      estimates_(reconfiguration_.MakeEstimates()),
      known_sd_(estimates_.sd) {
  if (monitor.twin() == nullptr) {
    throw InputError("tolerance", "the diagnosis has no twin, and no certain estimate",
                     "a noise on every sensor of the setup");
  }
  const std::vector<TwinFault>& faults = monitor.twin()->faults();
  bool same = faults.size() == plan.remedies.size();
  for (std::size_t i = 0; same && i < faults.size(); ++i) {
    same = faults[i].name == plan.remedies[i].fault;
  }
  if (!same) {
    throw InputError("tolerance", "its faults are not those of the diagnosis",
                     "a plan for the machine that is watched");
  }
}

void FaultTolerance::OnTick(std::span<const double> outputs,
                            std::span<const double> inputs) noexcept {
  diagnosis_.OnTick(outputs, inputs);
  // Of a twin that begins anew, what was sure a moment ago says nothing of the estimate.
  if (monitor_.estimate_sd() != known_sd_) {
    known_sd_ = monitor_.estimate_sd();
    ReadEstimates(monitor_, estimates_);
  }
  reconfiguration_.Observe(estimates_);
}

std::vector<Tolerated> Summarise(const Reconfiguration& reconfiguration,
                                 const Setup& setup) {
  std::vector<Tolerated> summary;
  const double tick = reconfiguration.options().sample_time;
  for (std::size_t i = 0; i < reconfiguration.remedies().size(); ++i) {
    const FaultRemedy& remedy = reconfiguration.remedies()[i];
    const RemedyState& state = reconfiguration.states()[i];
    if (state.since < 0) continue;
    const double healthy = IsDisturbance(setup, remedy.fault) ? 0.0 : 1.0;
    summary.push_back({remedy.fault, ActionOf(remedy, setup), healthy + state.acting,
                       static_cast<double>(state.since) * tick, state.certain,
                       static_cast<double>(state.until) * tick});
  }
  return summary;
}

}  // namespace mjdiag
