#pragma once
// Linear time-invariant systems as state space. [AB383], Eq. 8.

#include <Eigen/Core>

namespace mjdiag {

/// sample_time == 0:  dx/dt  = A x + B u,  y = C x + D u
/// sample_time  > 0:  x[k+1] = A x + B u,  y = C x + D u, one step every sample_time
/// [s]
struct StateSpace {
  Eigen::MatrixXd A;  ///< n x n
  Eigen::MatrixXd B;  ///< n x m
  Eigen::MatrixXd C;  ///< p x n
  Eigen::MatrixXd D;  ///< p x m
  double sample_time = 0.0;

  Eigen::Index states() const { return A.rows(); }
  Eigen::Index inputs() const { return B.cols(); }
  Eigen::Index outputs() const { return C.rows(); }
};

/// InputError names the matrix whose shape does not fit the others.
void RequireShapes(const StateSpace& system);

}  // namespace mjdiag
