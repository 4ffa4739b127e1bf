#include "mjdiag/report/normal_density.h"

#include <cmath>
#include <numbers>

namespace mjdiag {

Eigen::VectorXd NormalDensity(const NormalFit& fit, const Eigen::VectorXd& x) {
  return (-0.5 * ((x.array() - fit.mean) / fit.sd).square()).exp() /
         (fit.sd * std::sqrt(2.0 * std::numbers::pi));
}

}  // namespace mjdiag
