#include "mjdiag/diagnosis/diagnosis_result.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/diagnosis/statistics/magnitude_interval.h"
#include "mjdiag/diagnosis/twin/naming.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;

/// Outside an interval.
constexpr double kOutside = 0.05;

std::optional<double> TimeOf(const std::optional<Index>& sample, double sample_time) {
  if (!sample) return std::nullopt;
  return static_cast<double>(*sample) * sample_time;
}

/// What the residuals say of the faults, one by one, as a twin would put it. The
/// standard deviations are NaN as long as the motion does not tell all faults apart.
/// @param noise_ratio  variance of the noise over what the setup says of it
TwinReading ReadResiduals(const DiagnosisMonitor& monitor, double noise_ratio) {
  const DiagnosisDesign& design = monitor.design();
  const Index count = design.faults();
  TwinReading reading;
  reading.deviation = reading.sd = Eigen::VectorXd::Zero(count);
  reading.inseparable = monitor.estimator().Inseparable();
  FaultEstimate estimate{Eigen::VectorXd::Zero(count),
                         Eigen::MatrixXd::Constant(
                             count, count, std::numeric_limits<double>::quiet_NaN())};
  if (reading.inseparable.empty()) estimate = monitor.estimator().Estimate();
  const double reach = TwoSidedNormalQuantile(kFalseFault / static_cast<double>(count));
  for (Index i = 0; i < count; ++i) {
    const auto [deviation, sd, usual] =
        Calibrate(design, i, estimate.value[i],
                  std::sqrt(noise_ratio * estimate.covariance(i, i)));
    reading.deviation[i] = deviation;
    reading.sd[i] = sd;
    reading.ci95.push_back(NormalInterval(deviation, sd, kOutside));
    reading.named.push_back(std::abs(deviation) > reach * sd && !usual);
  }
  return reading;
}

/// Noisier sensors than the setup says make estimates from residuals less certain than
/// it says; a twin sees that itself.
TwinReading ReadFaults(const DiagnosisMonitor& monitor, double noise_ratio) {
  return monitor.twin() != nullptr ? monitor.twin()->Read()
                                   : ReadResiduals(monitor, noise_ratio);
}

std::vector<FaultVerdict> FaultVerdictsOf(const DiagnosisDesign& design,
                                          const TwinReading& reading) {
  const std::vector<std::string> names = design.FaultNames();
  std::vector<FaultVerdict> verdicts;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const double deviation = reading.deviation[at];
    const double healthy = design.Healthy(at);
    const Interval& ci95 = reading.ci95[i];
    verdicts.push_back({names[i],
                        healthy + deviation,
                        deviation,
                        reading.sd[at],
                        {healthy + ci95.min, healthy + ci95.max},
                        reading.named[i]});
    if (reading.alarm.size() == 0) continue;
    verdicts.back().alarm = reading.alarm[at];
    verdicts.back().best_alarm = reading.best_alarm[at];
  }
  return verdicts;
}

bool AnyDetected(const std::vector<FaultVerdict>& faults) {
  return std::any_of(faults.begin(), faults.end(),
                     [](const FaultVerdict& fault) { return fault.detected; });
}

/// The disturbance residual less what the detected faults put into it: harmonics of the
/// motion would pass for tones.
Eigen::VectorXd WithoutFaults(const DiagnosisDesign& design, const MonitorLog& log,
                              const std::vector<FaultVerdict>& faults) {
  const Eigen::MatrixXd parts =
      FilterSignals(design.disturbance.prefilters, log.signals);
  Eigen::VectorXd due = Eigen::VectorXd::Zero(parts.cols());
  for (Index i = 0; i < parts.rows(); ++i) {
    const FaultVerdict& fault = faults[static_cast<std::size_t>(i)];
    if (fault.detected) due += fault.deviation * parts.row(i).transpose();
  }
  SectionFilter high_pass(design.disturbance.high_pass);
  for (double& sample : due) sample = high_pass.Update(sample);
  return log.disturbance - due;
}

void RequireSeparableFaults(const DiagnosisDesign& design,
                            const std::vector<Index>& inseparable) {
  if (inseparable.empty()) return;
  const std::vector<std::string> names = design.FaultNames();
  std::string list;
  for (const Index fault : inseparable) {
    list += (list.empty() ? "" : ", ") + names[static_cast<std::size_t>(fault)];
  }
  throw InputError("regression",
                   inseparable.size() == 1
                       ? "this motion does not excite " + list
                       : "this motion does not tell these faults apart: " + list,
                   "a trajectory that moves every axis, or fewer fault parameters");
}

}  // namespace

CalibratedEstimate Calibrate(const DiagnosisDesign& design, Index fault,
                             double deviation, double sd) {
  if (design.limits.estimates.empty()) return {deviation, sd, false};
  const Interval& limits = design.limits.estimates[static_cast<std::size_t>(fault)];
  const double middle = 0.5 * (limits.min + limits.max);
  const double spread =
      0.5 * (limits.max - limits.min) / TwoSidedNormalQuantile(kOutsideLimits);
  return {deviation - middle, std::hypot(sd, spread), limits.Holds(deviation)};
}

std::vector<FaultVerdict> JudgeFaults(const DiagnosisMonitor& monitor) {
  return FaultVerdictsOf(monitor.design(), ReadFaults(monitor, 1.0));
}

DisturbanceReport AnalyseStretch(const DiagnosisDesign& design, const MonitorLog& log,
                                 const std::vector<FaultVerdict>& faults,
                                 Index skipped) {
  const Eigen::VectorXd left =
      AnyDetected(faults) ? WithoutFaults(design, log, faults) : log.disturbance;
  return AnalyseDisturbance(left.tail(left.size() - skipped), design.sample_time(),
                            design.limits.disturbance, design.options.disturbance);
}

DiagnosisResult Conclude(const DiagnosisMonitor& monitor, const MonitorLog& log) {
  const DiagnosisDesign& design = monitor.design();
  DiagnosisResult result;
  result.setup = design.setup;
  result.samples = monitor.samples();
  result.sample_time = design.sample_time();
  result.first_detection = TimeOf(monitor.first_detection(), result.sample_time);
  result.lasting = TimeOf(monitor.first_lasting(), result.sample_time);
  result.residual = {log.residual.minCoeff(), log.residual.maxCoeff()};
  result.limits = design.limits.residual.limits;
  const auto analyse = [&](const Eigen::VectorXd& disturbance) {
    return AnalyseDisturbance(disturbance, result.sample_time,
                              design.limits.disturbance, design.options.disturbance);
  };
  result.disturbance = analyse(log.disturbance);
  const TwinReading reading =
      ReadFaults(monitor, std::max(1.0, result.disturbance.noise_ratio));
  RequireSeparableFaults(design, reading.inseparable);
  result.faults = FaultVerdictsOf(design, reading);
  result.by_twin = monitor.twin() != nullptr;
  result.nis = reading.nis;
  result.model_records = reading.model_runs;
  if (AnyDetected(result.faults)) {
    result.disturbance = analyse(WithoutFaults(design, log, result.faults));
  }
  result.detected = result.first_detection.has_value() ||
                    result.disturbance.disturbed || AnyDetected(result.faults);
  return result;
}

DiagnosisResult Conclude(const DiagnosisRecording& recording) {
  return Conclude(recording.monitor, recording.recorder.Log());
}

}  // namespace mjdiag
