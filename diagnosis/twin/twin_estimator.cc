#include "mjdiag/diagnosis/twin/twin_estimator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

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
/// By chance the misfit is not above it: a mean of about a hundred squares.
constexpr double kExplained = 2.0;
constexpr double kDay = 86400.0;  // s

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

}  // namespace

TwinEstimator::TwinEstimator(MachineTwin machine, const PredictionErrorOptions& options)
    : faults_(std::move(machine.faults)),
      block_time_(machine.sample_time * static_cast<double>(machine.twin->block())),
      estimator_(std::move(machine.twin), std::move(machine.unknowns),
                 machine.sample_time, options) {}

void TwinEstimator::Read(Eigen::Ref<VectorXd> deviation) noexcept {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    deviation[static_cast<Index>(i)] =
        DeviationOf(faults_[i], estimator_.theta(), estimator_.LastVariance()).first;
  }
}

void TwinEstimator::ReadSpread(Eigen::Ref<VectorXd> sd) noexcept {
  const VectorXd& variance = estimator_.Variance();
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    sd[static_cast<Index>(i)] =
        DeviationOf(faults_[i], estimator_.theta(), variance).second;
  }
}

void TwinEstimator::ReadTones(const TwinFault& fault,
                              Eigen::Ref<VectorXd> parts) const noexcept {
  parts = estimator_.theta().segment(fault.first, 2 * fault.tones());
}

double TwinEstimator::FalseNaming() const {
  return estimator_.following() ? kFalseFault * block_time_ / kDay : kFalseFault;
}

TwinReading TwinEstimator::Read() const {
  const auto nf = static_cast<Index>(faults_.size());
  TwinReading reading;
  reading.deviation = reading.sd = VectorXd::Zero(nf);
  reading.named.assign(faults_.size(), false);
  if (!estimator_.began()) return reading;
  const Index active = estimator_.active();
  const VectorXd& theta = estimator_.theta();
  const MatrixXd information = estimator_.H().topLeftCorner(active, active);
  reading.misfit = estimator_.surprise();
  // A twin that does not explain what it sees is less sure than it says.
  const double honest = reading.misfit > kExplained ? reading.misfit : 1.0;
  const MatrixXd covariance = honest * CovarianceOf(information);
  const VectorXd variance = covariance.diagonal();
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
  if (!groups.empty() && estimator_.sure() && reading.misfit < kLargestMisfit) {
    reading.named = NameFaults(theta.head(active), covariance, groups, FalseNaming());
  }
  return reading;
}

}  // namespace mjdiag
