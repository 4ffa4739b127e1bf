#include "mjdiag/diagnosis/model/equilibrate.h"

#include <cmath>

namespace mjdiag {
namespace {

using Eigen::VectorXd;

double InverseRootNorm(double norm) { return norm > 0.0 ? 1.0 / std::sqrt(norm) : 1.0; }

}  // namespace

Equilibrated Equilibrate(const Eigen::MatrixXd& matrix) {
  Equilibrated result{matrix, VectorXd::Ones(matrix.rows()),
                      VectorXd::Ones(matrix.cols())};
  // Each sweep takes the square root of what is left of the imbalance.
  constexpr int kSweeps = 12;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const VectorXd rows = result.matrix.rowwise().norm().unaryExpr(&InverseRootNorm);
    const VectorXd columns =
        result.matrix.colwise().norm().transpose().unaryExpr(&InverseRootNorm);
    result.matrix = rows.asDiagonal() * result.matrix * columns.asDiagonal();
    result.rows.array() *= rows.array();
    result.columns.array() *= columns.array();
  }
  return result;
}

}  // namespace mjdiag
