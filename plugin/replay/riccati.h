#pragma once

#include <Eigen/Core>
#include <string>

namespace mjdiag {

/// The stabilising solution of
///
///   P = A P A^T - A P C^T (C P C^T + I)^-1 C P A^T + Q
///
/// by doubling (E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, "Structure-preserving
/// algorithms for periodic discrete-time algebraic Riccati equations", Int. J. Control
/// 77, 2004). States and outputs are best scaled to be alike.
/// @param tolerance  of a step against the solution, Frobenius norms
/// NumericalError with the text `failure` if there is none.
Eigen::MatrixXd SolveRiccati(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                             const Eigen::MatrixXd& Q, double tolerance,
                             const std::string& failure);

}  // namespace mjdiag
