#pragma once
// Least squares with amplitudes that may not be below something: friction does not push,
// and no motor is weaker than one that does nothing.

#include <Eigen/Core>
#include <optional>

namespace mjdiag {

struct BoundedRegression {
  Eigen::VectorXd amplitude;
  double gain = 0.0;  ///< squares that it takes away
};

/// Amplitudes a >= least of the columns of Phi that take most away of r:
///
///   gain = |r|^2 - |r - Phi a|^2 = 2 b^T a - a^T G a,  G = Phi^T Phi,  b = Phi^T r
///
/// For the few columns that a law has every set of columns at their bounds is tried. What
/// the others say already, or what has nothing to add (`explained`), is 0.
///
/// @param G          k x k, k columns
/// @param b          k
/// @param least      k, each at most 0; of no size: none has a bound
/// @param explained  k, whether a column says nothing
/// @return none if nothing is taken away
std::optional<BoundedRegression> RegressBounded(const Eigen::MatrixXd& G,
                                                const Eigen::VectorXd& b,
                                                const Eigen::VectorXd& least,
                                                const Eigen::ArrayX<bool>& explained);

}  // namespace mjdiag
