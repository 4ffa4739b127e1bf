#pragma once
// Rows and columns of comparable norm, before a rank is decided by singular values.

#include <Eigen/Core>

namespace mjdiag {

/// matrix = diag(rows) * original * diag(columns)
struct Equilibrated {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd rows;
  Eigen::VectorXd columns;
};

/// Rows and columns of zeros stay as they are.
Equilibrated Equilibrate(const Eigen::MatrixXd& matrix);

}  // namespace mjdiag
