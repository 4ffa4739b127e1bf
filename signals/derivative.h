#pragma once
// Derivatives of recorded signals by central differences,
//   dx/dt at t_k = (x[k+1] - x[k-1]) / (2 T)   + O(T^2)
// and one-sided differences of the same order at the ends,
//   (-3 x[0] + 4 x[1] - x[2]) / (2 T).

#include <Eigen/Core>

namespace mjdiag {

/// @param signal       [unit], at least three samples, else InputError
/// @param sample_time  T [s], > 0, else InputError
/// @return dx/dt [unit/s], as many samples as the signal has
Eigen::VectorXd CentralDifference(const Eigen::VectorXd& signal, double sample_time);

}  // namespace mjdiag
