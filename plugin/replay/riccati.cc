#include "mjdiag/plugin/replay/riccati.h"

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::MatrixXd;

MatrixXd SolveRiccati(const MatrixXd& A, const MatrixXd& C, const MatrixXd& Q,
                      double tolerance, const std::string& failure) {
  constexpr int kDoublings = 60;
  const Eigen::Index n = A.rows();
  const MatrixXd identity = MatrixXd::Identity(n, n);
  MatrixXd both(n, 2 * n);
  MatrixXd a = A.transpose();
  MatrixXd g = C.transpose() * C;
  MatrixXd h = Q;
  for (int i = 0; i < kDoublings; ++i) {
    both << a, g;
    both = Solve(identity + g * h, both);
    const auto wa = both.leftCols(n);
    const MatrixXd step = a.transpose() * h * wa;
    g += a * both.rightCols(n) * a.transpose();
    a = a * wa;
    h += step;
    h = 0.5 * (h + h.transpose()).eval();
    g = 0.5 * (g + g.transpose()).eval();
    if (!h.allFinite()) break;
    if (step.norm() <= tolerance * h.norm()) return h;
  }
  throw NumericalError(failure);
}

}  // namespace mjdiag
