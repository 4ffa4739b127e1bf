#include "mjdiag/diagnosis/twin/twin_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/diagnosis/statistics/magnitude_interval.h"
#include "mjdiag/diagnosis/twin/naming.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Part of what is known beforehand that data add which say nothing.
constexpr double kNothing = 1e-6;
/// Squared correlation of what two parameters do to the readings.
constexpr double kAlike = 1.0 - 1e-9;
/// By chance the NIS is not above it: a mean of about a hundred squares.
constexpr double kExplained = 2.0;
constexpr double kDay = 86400.0;  // s
/// That a machine which is constant is taken for one that is not.
constexpr double kConstant = 1e-3;
/// Outside an interval.
constexpr double kOutside = 0.05;

/// Deviation of a fault from healthy, and its standard deviation.
std::pair<double, double> DeviationOf(const TwinFault& fault, const VectorXd& theta,
                                      const VectorXd& variance) {
  if (fault.frequencies.empty()) {
    return {std::expm1(theta[fault.first]),
            std::exp(theta[fault.first]) * std::sqrt(variance[fault.first])};
  }
  double weights = 0.0;
  double squares = 0.0;
  for (Index i = 0; i < fault.tones(); ++i) {
    const Index at = fault.first + 2 * i;
    const double spread = variance[at] + variance[at + 1];
    const double weight = 2.0 / spread;
    squares += weight * (theta.segment(at, 2).squaredNorm() - spread);
    weights += weight;
  }
  return {std::sqrt(std::max(0.0, squares / weights)), 1.0 / std::sqrt(weights)};
}

Interval IntervalOf(const TwinFault& fault, double deviation, double sd) {
  if (fault.tones() == 0) return NormalInterval(deviation, sd, kOutside);
  return MagnitudeInterval(deviation, sd, 2 * fault.tones(), kOutside);
}

/// Of the unknowns of those names, one for each. An unknown that is not there has none.
std::vector<Index> PlacesOf(const std::vector<std::string>& names,
                            const std::vector<Unknown>& unknowns) {
  std::vector<Index> places;
  for (const std::string& name : names) {
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      const auto at = static_cast<Index>(i);
      if (unknowns[i].name != name || std::ranges::find(places, at) != places.end())
        continue;
      places.push_back(at);
      break;
    }
  }
  return places;
}

}  // namespace

TwinEstimator::TwinEstimator(MachineTwin machine, const PredictionErrorOptions& options)
    : faults_(std::move(machine.faults)),
      model_(std::move(machine.model)),
      uncertain_(PlacesOf(model_.unknowns, machine.unknowns)),
      sample_time_(machine.sample_time),
      block_time_(machine.sample_time * static_cast<double>(machine.twin->block())),
      spread_(VectorXd::Zero(machine.twin->unknowns())),
      model_variance_(spread_),
      estimator_(std::move(machine.twin), std::move(machine.unknowns),
                 machine.sample_time, options) {
  if (!model_.any()) return;
  model_variance_(uncertain_) =
      std::pow(model_.Stretch(kOutside, kOutside), 2) * model_.covariance.diagonal();
}

void TwinEstimator::Read(Eigen::Ref<VectorXd> deviation) noexcept {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    deviation[static_cast<Index>(i)] =
        DeviationOf(faults_[i], estimator_.theta(), estimator_.LastVariance()).first;
  }
}

void TwinEstimator::ReadSpread(Eigen::Ref<VectorXd> sd) noexcept {
  spread_ = estimator_.Variance();
  if (model_.any()) spread_ += model_.Times(Duration()) * model_variance_;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    sd[static_cast<Index>(i)] =
        DeviationOf(faults_[i], estimator_.theta(), spread_).second;
  }
}

void TwinEstimator::ReadTones(const TwinFault& fault,
                              Eigen::Ref<VectorXd> parts) const noexcept {
  parts = estimator_.theta().segment(fault.first, 2 * fault.tones());
}

double TwinEstimator::FalseNaming() const {
  return estimator_.following() ? kFalseFault * block_time_ / kDay : kFalseFault;
}

double TwinEstimator::Duration() const {
  return std::max(block_time_,
                  sample_time_ * static_cast<double>(estimator_.horizon()));
}

MatrixXd TwinEstimator::WithModel(const MatrixXd& noise, double times) const {
  MatrixXd covariance = noise;
  if (model_.any()) covariance(uncertain_, uncertain_) += times * model_.covariance;
  return covariance;
}

void TwinEstimator::FindAlarms(const MatrixXd& covariance, VectorXd& alarm) const {
  // Of one alone: beside others that are healthy.
  std::vector<Index> places;
  for (const TwinFault& fault : faults_) {
    for (Index i = 0; i < std::max<Index>(1, 2 * fault.tones()); ++i) {
      places.push_back(fault.first + i);
    }
  }
  const MatrixXd told = CovarianceOf(covariance(places, places));
  const double sigmas =
      TwoSidedNormalQuantile(FalseNaming() / static_cast<double>(faults_.size()));
  alarm.setConstant(static_cast<Index>(faults_.size()),
                    std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    if (!faults_[i].frequencies.empty()) continue;
    const auto place = std::ranges::find(places, faults_[i].first) - places.begin();
    alarm[static_cast<Index>(i)] = std::expm1(sigmas / std::sqrt(told(place, place)));
  }
}

TwinReading TwinEstimator::Read() const {
  const auto nf = static_cast<Index>(faults_.size());
  TwinReading reading;
  reading.deviation = reading.sd = VectorXd::Zero(nf);
  reading.ci95.assign(faults_.size(), {});
  reading.named.assign(faults_.size(), false);
  if (!estimator_.began()) return reading;
  const Index active = estimator_.active();
  VectorXd theta = estimator_.theta();
  MatrixXd information = estimator_.H().topLeftCorner(active, active);
  if (estimator_.constant()) {
    Drift drift = estimator_.drift();
    drift.Solve(estimator_.information(), estimator_.drift_time(), kRateSpread);
    const auto rates = static_cast<double>(drift.drifting().size());
    if (drift.gain() > ChiSquaredQuantile(kConstant, rates)) {
      theta += drift.change();
      information = drift.information().topLeftCorner(active, active);
    }
  }
  reading.nis = estimator_.recent_nis();
  // A twin that does not explain what it sees is less sure than it says.
  const double honest = reading.nis > kExplained ? reading.nis : 1.0;
  const MatrixXd noise = honest * CovarianceOf(information);
  // Its model was off in a few healthy runs by so much, once: that is one draw, however
  // often one looks, and has the tail of Student's t.
  const double times = model_.any() ? model_.Times(Duration()) : 0.0;
  const auto stretched = [&](double probability, double normal) {
    return model_.any() ? std::pow(model_.Stretch(probability, normal), 2) : 0.0;
  };
  const VectorXd variance =
      WithModel(noise, times * stretched(kOutside, kOutside)).diagonal();
  std::vector<std::vector<Index>> groups;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const TwinFault& fault = faults_[i];
    const auto at = static_cast<Index>(i);
    std::vector<Index> group(
        static_cast<std::size_t>(std::max<Index>(1, 2 * fault.tones())));
    std::iota(group.begin(), group.end(), fault.first);
    groups.push_back(std::move(group));
    std::tie(reading.deviation[at], reading.sd[at]) =
        DeviationOf(fault, theta, variance);
    reading.ci95[i] = IntervalOf(fault, reading.deviation[at], reading.sd[at]);
  }
  const VectorXd prior = estimator_.prior().diagonal();
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const Index at = faults_[i].first;
    const double own = information(at, at) - prior[at];
    bool alike = own < kNothing * prior[at];
    for (std::size_t k = 0; k < faults_.size() && !alike; ++k) {
      const Index other = faults_[k].first;
      alike = k != i && faults_[i].frequencies.empty() &&
              faults_[k].frequencies.empty() &&
              std::pow(information(at, other), 2) >
                  kAlike * own * (information(other, other) - prior[other]);
    }
    if (alike && faults_[i].frequencies.empty()) {
      reading.inseparable.push_back(static_cast<Index>(i));
    }
  }
  const auto each = static_cast<double>(faults_.size());
  const double look = FalseNaming() / each;
  const MatrixXd judged = WithModel(noise, times * stretched(kFalseFault / each, look));
  FindAlarms(judged, reading.alarm);
  const double normal =
      TwoSidedNormalQuantile(kFalseFault / each) / TwoSidedNormalQuantile(look);
  FindAlarms(WithModel(noise, (times - 1.0) * normal * normal), reading.best_alarm);
  reading.model_runs = model_.any() ? model_.runs : 0;
  if (!groups.empty() && estimator_.sure() && reading.nis < kLargestNis) {
    reading.named = NameFaults(theta.head(active), judged, groups, FalseNaming());
  }
  return reading;
}

}  // namespace mjdiag
