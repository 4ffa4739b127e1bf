#pragma once
// The least value of a function with a slope, within bounds: BFGS whose curvature stays
// positive (M. J. D. Powell, "Algorithms for nonlinear constraints that use Lagrangian
// functions", Math. Program. 14, 1978), of what no bound holds, in steps of 1.5 at most.
// Made for logarithms.

#include <Eigen/Core>
#include <functional>

namespace mjdiag {

/// A value with its slope; a value that is not finite is refused.
struct Sloped {
  double value = 0.0;
  Eigen::VectorXd slope;
};

struct Least {
  Eigen::VectorXd x;
  double value = 0.0;
};

/// @param start  is moved within the bounds first
/// @param end    gains of two steps in a row below which it ends
Least DescendWithin(const std::function<Sloped(const Eigen::VectorXd&)>& of,
                    const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                    const Eigen::VectorXd& upper, double end);

}  // namespace mjdiag
