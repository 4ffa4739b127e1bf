#include "mjdiag/signals/noise_level.h"

#include <cmath>
#include <string>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/median.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Median of |e| of a standard Gaussian e.
constexpr double kGaussianMedian = 0.674489750196081743;
constexpr int kMostDifferences = 12;

/// binomial(2 m, m)
double CentralBinomial(int m) {
  double value = 1.0;
  for (int i = 1; i <= m; ++i) value *= static_cast<double>(m + i) / i;
  return value;
}

}  // namespace

double NoiseLevel(const VectorXd& signal, int order) {
  if (order < 1 || order > kMostDifferences) {
    throw InputError("noise level", "differences of order " + std::to_string(order),
                     "1 to " + std::to_string(kMostDifferences));
  }
  if (signal.size() <= order + 2) {
    throw InputError("noise level",
                     "a signal of " + std::to_string(signal.size()) + " samples",
                     "more than " + std::to_string(order + 2));
  }
  VectorXd differences = signal;
  for (int i = 0; i < order; ++i) {
    const Index size = differences.size() - 1;
    differences = (differences.tail(size) - differences.head(size)).eval();
  }
  return Median(differences.cwiseAbs()) /
         (kGaussianMedian * std::sqrt(CentralBinomial(order)));
}

}  // namespace mjdiag
