#pragma once
// What one number of a machine is of its mechanical model.

#include <Eigen/Core>
#include <vector>

namespace mjdiag {

/// What a number of the machine adds to the model where it is what it should be; empty
/// matrices: nothing.
struct ModelPart {
  Eigen::MatrixXd M;      ///< nq x nq
  Eigen::MatrixXd D;      ///< nq x nq
  Eigen::MatrixXd K;      ///< nq x nq
  Eigen::MatrixXd Gamma;  ///< nq x nu
  Eigen::VectorXd force;  ///< nq, beyond what holds the machine at its nominal rest
  /// Its unknown factors.
  std::vector<Eigen::Index> factors;
};

}  // namespace mjdiag
