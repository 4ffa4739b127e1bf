#include "mjdiag/diagnosis/twin/naming.h"

#include <limits>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What the fit loses without the unknowns of the groups that are not named.
double LossWithout(const VectorXd& deviations, const MatrixXd& covariance,
                   const std::vector<std::vector<Index>>& groups,
                   const std::vector<bool>& named) {
  std::vector<Index> left_out;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (!named[i]) left_out.insert(left_out.end(), groups[i].begin(), groups[i].end());
  }
  if (left_out.empty()) return 0.0;
  const VectorXd d = deviations(left_out);
  // In standard deviations, for they may be of any unit.
  const VectorXd sd = covariance.diagonal()(left_out).cwiseSqrt();
  const MatrixXd correlation = sd.cwiseInverse().asDiagonal() *
                               covariance(left_out, left_out) *
                               sd.cwiseInverse().asDiagonal();
  const VectorXd scaled = d.cwiseQuotient(sd);
  return scaled.dot(VectorXd(LeastNorm(correlation, scaled)));
}

}  // namespace

std::vector<bool> NameFaults(const VectorXd& deviations, const MatrixXd& covariance,
                             const std::vector<std::vector<Index>>& groups,
                             double false_naming) {
  std::vector<double> price;
  for (const std::vector<Index>& group : groups) {
    price.push_back(
        ChiSquaredQuantile(false_naming / static_cast<double>(groups.size()),
                           static_cast<double>(group.size())));
  }
  const auto criterion = [&](const std::vector<bool>& named) {
    double sum = LossWithout(deviations, covariance, groups, named);
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if (named[i]) sum += price[i];
    }
    return sum;
  };
  // From all of them, one is taken out or put back as long as that is better.
  std::vector<bool> named(groups.size(), true);
  double best = criterion(named);
  for (bool better = true; better;) {
    better = false;
    std::size_t change = 0;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      std::vector<bool> other = named;
      other[i] = !other[i];
      if (const double value = criterion(other); value < best) {
        best = value;
        change = i;
        better = true;
      }
    }
    if (better) named[change] = !named[change];
  }
  return named;
}

}  // namespace mjdiag
