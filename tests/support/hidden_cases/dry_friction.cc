#include "support/hidden_cases/dry_friction.h"

#include <algorithm>

namespace mjdiag::test {

// Joint after joint until nothing moves (projected Gauss-Seidel).
Eigen::VectorXd DryFriction(const Eigen::MatrixXd& A, const Eigen::VectorXd& w,
                            const Eigen::VectorXd& bound) {
  constexpr int kMostRounds = 200;
  constexpr double kConverged = 1e-13;  // of the bound
  Eigen::VectorXd f = Eigen::VectorXd::Zero(w.size());
  for (int round = 0; round < kMostRounds; ++round) {
    double moved = 0.0;
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      if (bound[i] <= 0.0) continue;
      const double before = f[i];
      f[i] =
          std::clamp(before - (w[i] + A.row(i).dot(f)) / A(i, i), -bound[i], bound[i]);
      moved = std::max(moved, std::abs(f[i] - before) / bound[i]);
    }
    if (moved < kConverged) break;
  }
  return f;
}

}  // namespace mjdiag::test
