#include "mjdiag/plugin/replay/bounded_descent.h"

#include <Eigen/Cholesky>
#include <utility>
#include <vector>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// -B^-1 slope of what is free.
VectorXd DirectionOf(const MatrixXd& B, const VectorXd& slope,
                     const std::vector<Index>& free) {
  constexpr double kMost = 1.5;
  VectorXd direction = VectorXd::Zero(slope.size());
  if (free.empty()) return direction;
  direction(free) = -MatrixXd(B(free, free)).llt().solve(VectorXd(slope(free)));
  const double largest = direction.cwiseAbs().maxCoeff();
  if (largest > kMost) direction *= kMost / largest;
  return direction;
}

}  // namespace

Least DescendWithin(const std::function<Sloped(const VectorXd&)>& of,
                    const VectorXd& start, const VectorXd& lower, const VectorXd& upper,
                    double end) {
  constexpr int kSteps = 30;
  constexpr double kStiffer = 8.0;
  VectorXd x = start.cwiseMax(lower).cwiseMin(upper);
  Sloped here = of(x);
  // A first step of 1 in all that slopes.
  MatrixXd B = MatrixXd(here.slope.cwiseAbs().cwiseMax(1.0).asDiagonal());
  int little = 0;
  for (int step = 0; step < kSteps && little < 2; ++step) {
    std::vector<Index> free;
    for (Index i = 0; i < x.size(); ++i) {
      const bool held = (x[i] <= lower[i] && here.slope[i] >= 0.0) ||
                        (x[i] >= upper[i] && here.slope[i] <= 0.0);
      if (!held) free.push_back(i);
    }
    const VectorXd direction = DirectionOf(B, here.slope, free);
    if (direction.isZero(0.0) || !direction.allFinite()) break;
    const VectorXd next = (x + direction).cwiseMax(lower).cwiseMin(upper);
    const VectorXd s = next - x;
    Sloped there = of(next);
    const double gained = here.value - there.value;
    if (!(gained > 0.0)) {
      B *= kStiffer;
      if (-here.slope.dot(s) < end) break;
      continue;
    }
    const VectorXd Bs = B * s;
    const double sBs = s.dot(Bs);
    VectorXd y = there.slope - here.slope;
    const double sy = s.dot(y);
    if (sy < 0.2 * sBs) y += (0.8 * sBs / (sBs - sy)) * (Bs - y);
    B += y * y.transpose() / s.dot(y) - Bs * Bs.transpose() / sBs;
    // Where it bends less than was thought it does so along other directions, too.
    if (gained > -0.9 * here.slope.dot(s) - 0.5 * sBs) B *= 0.5;
    x = next;
    here = std::move(there);
    little = gained > end ? 0 : little + 1;
  }
  return {x, here.value};
}

}  // namespace mjdiag
