#pragma once
// The median, the middle that outliers cannot move.

#include <Eigen/Core>

namespace mjdiag {

/// The middle value in order of size, of an even number of values the upper of the two.
/// @param values  at least one, none NaN
double Median(Eigen::VectorXd values);

}  // namespace mjdiag
