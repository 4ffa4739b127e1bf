#pragma once
// The least value of a function with a slope, within bounds: BFGS whose curvature stays
// positive (M. J. D. Powell, "Algorithms for nonlinear constraints that use Lagrangian
// functions", Math. Program. 14, 1978), each step to where the parabola is least within the
// bounds and a box around the point, which grows and shrinks as the parabola holds
// (J. Nocedal, S. J. Wright, Numerical Optimization, 2006, chapter 4). Made for logarithms:
// the box begins at 1.5.

#include <Eigen/Core>
#include <functional>

namespace mjdiag {

/// A value with its slope; a value that is not finite is refused.
struct Sloped {
  double value = 0.0;
  Eigen::VectorXd slope;
  /// How it bends, positive definite: asked for at the start only, may be empty.
  Eigen::MatrixXd curvature;
};

struct Least {
  Eigen::VectorXd x;
  double value = 0.0;
};

/// The s of g' s + s' B s / 2 that is least with low <= s <= high, by an active set.
/// @param B     positive definite
/// @param low   0 or less
/// @param high  0 or more
Eigen::VectorXd LeastWithin(const Eigen::MatrixXd& B, const Eigen::VectorXd& g,
                            const Eigen::VectorXd& low, const Eigen::VectorXd& high);

/// Of a step along which nothing was gained, the part to where the parabola through both of
/// its ends is least, a tenth to a half.
/// @param slope  along the whole step, less than 0
/// @param lost   by it; may be infinite
double ShorterBy(double slope, double lost);

/// @param start  is moved within the bounds first
/// @param end    gains of two steps in a row below which it ends
Least DescendWithin(const std::function<Sloped(const Eigen::VectorXd&)>& of,
                    const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                    const Eigen::VectorXd& upper, double end);

}  // namespace mjdiag
