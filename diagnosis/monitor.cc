#include "mjdiag/diagnosis/monitor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A transient that has decayed to this part is no longer seen.
constexpr double kDecayed = 1e-6;
/// A first reading within this many standard deviations is one at rest.
constexpr double kSigmas = 6.0;
/// Regressed samples after which standard deviations are looked at again.
constexpr Index kSpreadEvery = 16;

VectorXd SignalNoise(const DiagnosisDesign& design) {
  VectorXd noise = VectorXd::Zero(design.bank.filters.inputs());
  noise.head(design.sensor_noise.size()) = design.sensor_noise;
  return noise;
}

/// The residual generators with the commands' columns repeated for every disturbance:
/// residuals that a unit of each leaves. What the machine gets beyond u is what R lacks
/// in u, hence the sign.
FilterBank WaveformBank(const DiagnosisDesign& design) {
  const FilterBank& all = design.bank.filters;
  const Index n = design.bank.residuals;
  const Index m = all.outputs();
  const auto ny = static_cast<Index>(design.outputs.size());
  const Index nu = all.inputs() - ny;
  const auto count = static_cast<Index>(design.disturbances.size());
  FilterBank bank = all;
  bank.B = MatrixXd::Zero(all.order() * n * count, nu * count);
  bank.D = MatrixXd::Zero(n * count, nu * count);
  for (Index i = 0; i < count; ++i) {
    for (Index k = 0; k < all.order(); ++k) {
      bank.B.block((k * count + i) * n, i * nu, n, nu) = -all.B.block(k * m, ny, n, nu);
    }
    bank.D.block(i * n, i * nu, n, nu) = -all.D.block(0, ny, n, nu);
  }
  return bank;
}

double ForgettingFactor(const DiagnosisDesign& design) {
  const double time = design.options.forgetting;
  return time > 0.0 ? std::exp(-design.decimation * design.sample_time() / time) : 1.0;
}

Index WindowSamples(const DiagnosisDesign& design) {
  const double samples = design.options.integral_window / design.sample_time();
  return std::max<Index>(1, static_cast<Index>(std::lround(samples)));
}

}  // namespace

DiagnosisMonitor::DiagnosisMonitor(const DiagnosisDesign& design, MatrixXd baseline)
    : design_(design),
      baseline_(std::move(baseline)),
      filters_(design.bank.filters),
      disturbance_filter_(design.disturbance.filter),
      waveform_filter_(WaveformBank(design)),
      high_pass_(design.disturbance.high_pass),
      estimator_(design.faults(),
                 MakeResidualNoise(design.bank.filters, design.bank.residuals,
                                   SignalNoise(design), design.decimation),
                 ForgettingFactor(design), true),
      settling_away_(SettlingSamples(design.bank.filters, kDecayed)),
      z_(VectorXd::Zero(design.bank.filters.inputs())),
      readings_(design.outputs.size()),
      residuals_(VectorXd::Zero(design.bank.residuals)),
      regressors_(MatrixXd::Zero(design.faults(), design.bank.residuals)),
      waveforms_(MatrixXd::Zero(static_cast<Index>(design.inputs.size()),
                                static_cast<Index>(design.disturbances.size()))),
      drive_(VectorXd::Zero(waveforms_.size())),
      estimate_(VectorXd::Zero(design.faults())),
      estimate_sd_(VectorXd::Constant(design.faults(),
                                      std::numeric_limits<double>::quiet_NaN())),
      window_(VectorXd::Zero(WindowSamples(design))) {
  if (baseline_.size() > 0 && baseline_.rows() != design.bank.residuals) {
    throw InputError("baseline", std::to_string(baseline_.rows()) + " residuals",
                     std::to_string(design.bank.residuals));
  }
}

void DiagnosisMonitor::Follow(std::unique_ptr<TwinEstimator> twin) {
  const std::vector<std::string> names = design_.FaultNames();
  bool same = twin->faults().size() == names.size();
  for (std::size_t i = 0; same && i < names.size(); ++i) {
    same = twin->faults()[i].name == names[i];
  }
  if (!same) {
    throw InputError("twin", "its faults are not those of the filters",
                     "a twin of the machine that the filters are made for");
  }
  twin_ = std::move(twin);
  filters_.KeepFirst(design_.bank.residuals);
}

void DiagnosisMonitor::Finish() noexcept {
  if (!twin_) return;
  twin_->CatchUp();
  if (twin_->estimator().began()) twin_->ReadSpread(estimate_sd_);
  twin_->Read(estimate_);
}

void DiagnosisMonitor::Start() noexcept {
  const Index ny = design_.offset.size();
  for (Index i = 0; i < ny; ++i) {
    if (std::abs(z_[i]) > kSigmas * design_.sensor_noise[i]) {
      // The record begins elsewhere than at rest. Settling on a reading with noise
      // leaves a transient, which has to die before anything is judged.
      filters_.Settle(z_);
      disturbance_filter_.Settle(z_);
      settling_ = std::max(settling_, settling_away_);
      return;
    }
  }
}

void DiagnosisMonitor::Add(std::span<const double> outputs,
                           std::span<const double> inputs) noexcept {
  Add(outputs, outputs, inputs);
}

void DiagnosisMonitor::Add(std::span<const double> outputs,
                           std::span<const double> inputs,
                           std::span<const bool> measured, bool gap) noexcept {
  for (std::size_t i = 0; i < readings_.size(); ++i) {
    readings_[i] = measured[i] ? outputs[i] : std::numeric_limits<double>::quiet_NaN();
  }
  if (gap) settling_ = std::max(settling_, samples_ + 1 + settling_away_);
  Add(outputs, readings_, inputs);
}

void DiagnosisMonitor::Add(std::span<const double> outputs,
                           std::span<const double> readings,
                           std::span<const double> inputs) noexcept {
  const Index ny = design_.offset.size();
  for (Index i = 0; i < ny; ++i) {
    z_[i] = outputs[static_cast<std::size_t>(i)] - design_.offset[i];
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    z_[ny + static_cast<Index>(i)] = inputs[i];
  }
  if (samples_ == 0) Start();

  const VectorXd& filtered = filters_.Step(z_);
  const Index n = design_.bank.residuals;
  residuals_ = filtered.head(n);
  if (samples_ < baseline_.cols()) residuals_ -= baseline_.col(samples_);
  if (!twin_) MakeRegressors(filtered);
  disturbance_ = high_pass_.Update(disturbance_filter_.Step(z_)[0]);

  Detect();
  regressed_ = samples_ >= std::max(settling_, first_regressed_) &&
               samples_ % design_.decimation == 0;
  if (twin_ && samples_ >= first_regressed_) twin_->Add(readings, inputs);
  if (regressed_) Regress();
  ++samples_;
}

void DiagnosisMonitor::MakeRegressors(const VectorXd& filtered) noexcept {
  const Index n = design_.bank.residuals;
  const auto parameters = static_cast<Index>(design_.bank.faults.size());
  for (Index i = 0; i < parameters; ++i) {
    regressors_.row(i) = filtered.segment((i + 1) * n, n).transpose();
  }
  if (waveforms_.cols() == 0) return;
  Waveforms(design_.disturbances, static_cast<double>(samples_) * design_.sample_time(),
            waveforms_);
  drive_ = waveforms_.reshaped();
  const VectorXd& response = waveform_filter_.Step(drive_);
  for (Index i = 0; i < waveforms_.cols(); ++i) {
    regressors_.row(parameters + i) = response.segment(i * n, n).transpose();
  }
}

void DiagnosisMonitor::Detect() noexcept {
  const double residual = residuals_[0];
  double& oldest = window_[samples_ % window_.size()];
  const double level = samples_ < settling_ ? 0.0 : std::abs(residual);
  window_sum_ += level - oldest;
  oldest = level;
  integral_ = window_sum_ / static_cast<double>(window_.size());
  const bool judged = design_.limits.known && samples_ >= settling_;
  residual_alarm_ = judged && !design_.limits.residual.limits.Holds(residual);
  lasting_alarm_ = judged && integral_ > design_.limits.integral;
  if (first_detection_ < 0 && residual_alarm_) first_detection_ = samples_;
  if (first_lasting_ < 0 && lasting_alarm_) first_lasting_ = samples_;
}

void DiagnosisMonitor::Regress() noexcept {
  if (twin_) {
    if (twin_->estimator().began() &&
        samples_ % (kSpreadEvery * design_.decimation) == 0) {
      twin_->ReadSpread(estimate_sd_);
    }
    twin_->Read(estimate_);
    return;
  }
  if (estimator_.samples() == 0 && samples_ > 0) estimator_.AssumeStationary();
  estimator_.Add(residuals_, regressors_);
  estimator_.Solve(estimate_);
}

std::optional<Index> DiagnosisMonitor::first_detection() const {
  return first_detection_ < 0 ? std::nullopt : std::optional(first_detection_);
}

std::optional<Index> DiagnosisMonitor::first_lasting() const {
  return first_lasting_ < 0 ? std::nullopt : std::optional(first_lasting_);
}

}  // namespace mjdiag
