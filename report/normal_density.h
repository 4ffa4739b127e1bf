#pragma once
// The fitted normal distribution that histograms of residuals are drawn with.

#include <Eigen/Core>

#include "mjdiag/diagnosis/thresholds.h"

namespace mjdiag {

/// exp(-(x - mean)^2 / 2 sd^2) / (sd sqrt(2 pi)) at every x. @param fit  sd > 0
Eigen::VectorXd NormalDensity(const NormalFit& fit, const Eigen::VectorXd& x);

}  // namespace mjdiag
