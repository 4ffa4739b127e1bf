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
  // From all and from none, one is taken out, put in or exchanged for another as long as
  // that is better.
  const std::size_t n = groups.size();
  std::vector<bool> best(n, false);
  double least = criterion(best);
  for (const bool all : {true, false}) {
    std::vector<bool> named(n, all);
    double now = criterion(named);
    std::vector<bool> next = named;
    for (bool better = true; better; named = next) {
      better = false;
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = i; k < n; ++k) {
          if (k > i && named[i] == named[k]) continue;
          std::vector<bool> other = named;
          other[i] = !other[i];
          if (k > i) other[k] = !other[k];
          if (const double value = criterion(other); value < now) {
            now = value;
            next = other;
            better = true;
          }
        }
      }
    }
    if (now < least) {
      least = now;
      best = named;
    }
  }
  return best;
}

}  // namespace mjdiag
