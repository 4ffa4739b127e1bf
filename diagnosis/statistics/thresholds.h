#pragma once
// Thresholds of a residual, [AB383], Eq. 20 and 21: healthy while
//   r_min < r(t) < r_max
//   r_max = alpha max_i max_t r_i(t),  r_min = alpha min_i min_t r_i(t)
// over nominal trajectories i. The margin alpha is given, or follows from a normal
// distribution fitted to the nominal residuals and a wanted rate of false alarms.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/statistics/interval.h"

namespace mjdiag {

struct NormalFit {
  double mean = 0.0;
  double sd = 0.0;
};

/// Counts of the nominal samples in equal bins over [edges.front(), edges.back()].
struct Histogram {
  std::vector<double> edges;        ///< bins + 1
  std::vector<Eigen::Index> count;  ///< bins
};

struct ThresholdDesign {
  Interval limits;
  double alpha = 0.0;  ///< the margin used or found
  NormalFit fit;
  Histogram histogram;
};

/// Eq. 21. InputError if there is no nominal residual or alpha < 1.
ThresholdDesign ThresholdsByMargin(const std::vector<Eigen::VectorXd>& nominal,
                                   double alpha);

/// Limits mean -+ k sd of the fitted normal distribution that a healthy residual leaves
/// with the given probability within `samples` independent samples (Bonferroni, so an
/// upper bound for dependent ones); alpha is the ratio of the limits to the extremes
/// seen. InputError unless 0 < probability < 1.
ThresholdDesign ThresholdsByFalseAlarms(const std::vector<Eigen::VectorXd>& nominal,
                                        double probability, double samples);

}  // namespace mjdiag
