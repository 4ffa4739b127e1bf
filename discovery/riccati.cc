#include "mjdiag/discovery/riccati.h"

#include <Eigen/LU>

#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::MatrixXd;

MatrixXd SolveRiccati(const MatrixXd& A, const MatrixXd& C, const MatrixXd& Q,
                      double tolerance, const std::string& failure) {
  constexpr int kDoublings = 60;
  const MatrixXd identity = MatrixXd::Identity(A.rows(), A.rows());
  MatrixXd a = A.transpose();
  MatrixXd g = C.transpose() * C;
  MatrixXd h = Q;
  for (int i = 0; i < kDoublings; ++i) {
    const Eigen::PartialPivLU<MatrixXd> w(identity + g * h);
    const MatrixXd wa = w.solve(a);
    const MatrixXd step = a.transpose() * h * wa;
    g += a * w.solve(g) * a.transpose();
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
