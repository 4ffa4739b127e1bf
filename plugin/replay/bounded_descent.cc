#include "mjdiag/plugin/replay/bounded_descent.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Where each of s is held: -1 at its lower bound, 1 at its upper one, 0 free.
using Held = std::vector<int>;

std::vector<Index> FreeOf(const Held& held) {
  std::vector<Index> free;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) free.push_back(static_cast<Index>(i));
  }
  return free;
}

/// The one that its bound holds back most, by what is to be gained; -1 if none does.
Index MostHeldBack(const Held& held, const VectorXd& slope, const MatrixXd& B) {
  Index most = -1;
  double gain = 1e-12;
  for (Index i = 0; i < slope.size(); ++i) {
    const double wants = slope[i] * held[static_cast<std::size_t>(i)];
    if (wants > 0.0 && wants * wants / B(i, i) > gain) {
      gain = wants * wants / B(i, i);
      most = i;
    }
  }
  return most;
}

/// The secant of a step, damped so that B stays positive.
void Learn(const VectorXd& s, VectorXd y, MatrixXd& B) {
  constexpr double kDamped = 0.05;
  const VectorXd Bs = B * s;
  const double sBs = s.dot(Bs);
  const double sy = s.dot(y);
  if (!(sBs > 0.0) || !y.allFinite()) return;
  if (sy < kDamped * sBs) y += ((1.0 - kDamped) * sBs / (sBs - sy)) * (Bs - y);
  B += y * y.transpose() / s.dot(y) - Bs * Bs.transpose() / sBs;
}

MatrixXd CurvatureAt(const Sloped& start) {
  if (start.curvature.size() > 0) return start.curvature;
  // A first step of 1 in all that slopes.
  return start.slope.cwiseAbs().cwiseMax(1.0).asDiagonal();
}

}  // namespace

VectorXd LeastWithin(const MatrixXd& B, const VectorXd& g, const VectorXd& low,
                     const VectorXd& high) {
  VectorXd s = VectorXd::Zero(g.size());
  Held held(static_cast<std::size_t>(g.size()), 0);
  // Every turn holds or frees one; more than some for each is a circle of roundings.
  for (Index turn = 0; turn < 4 * g.size(); ++turn) {
    const std::vector<Index> free = FreeOf(held);
    VectorXd to = VectorXd::Zero(g.size());
    if (!free.empty()) {
      const VectorXd slope = g + B * s;
      to(free) = -MatrixXd(B(free, free)).llt().solve(VectorXd(slope(free)));
    }
    // As far as the first bound.
    double part = 1.0;
    Index first = -1;
    for (const Index i : free) {
      if (to[i] == 0.0) continue;
      const double room = ((to[i] > 0.0 ? high[i] : low[i]) - s[i]) / to[i];
      if (room < part) {
        part = room;
        first = i;
      }
    }
    s += part * to;
    if (first >= 0) {
      s[first] = to[first] > 0.0 ? high[first] : low[first];
      held[static_cast<std::size_t>(first)] = to[first] > 0.0 ? 1 : -1;
      continue;
    }
    const VectorXd slope = g + B * s;
    const Index back = MostHeldBack(held, slope, B);
    if (back < 0) break;
    held[static_cast<std::size_t>(back)] = 0;
  }
  return s.cwiseMax(low).cwiseMin(high);
}

double ShorterBy(double slope, double lost) {
  if (!std::isfinite(lost)) return 0.1;
  return std::clamp(-0.5 * slope / (lost - slope), 0.1, 0.5);
}

Least DescendWithin(const std::function<Sloped(const VectorXd&)>& of,
                    const VectorXd& start, const VectorXd& lower, const VectorXd& upper,
                    double end) {
  constexpr int kSteps = 40;
  constexpr double kMost = 12.0;
  VectorXd x = start.cwiseMax(lower).cwiseMin(upper);
  Sloped here = of(x);
  MatrixXd B = CurvatureAt(here);
  double radius = 1.5;
  int little = 0;
  for (int step = 0; step < kSteps && little < 2; ++step) {
    const VectorXd s = LeastWithin(B, here.slope, (lower - x).cwiseMax(-radius),
                                   (upper - x).cwiseMin(radius));
    const double along = here.slope.dot(s);
    const VectorXd Bs = B * s;
    const double hoped = -along - 0.5 * s.dot(Bs);
    if (!(hoped > 0.0)) break;
    const double size = s.cwiseAbs().maxCoeff();
    Sloped there = of(x + s);
    const double gained = here.value - there.value;
    if (std::isfinite(there.value)) Learn(s, there.slope - here.slope, B);
    if (!(gained > 0.0)) {
      if (hoped < end) break;
      radius = ShorterBy(along, -gained) * size;
      continue;
    }
    if (gained > 0.75 * hoped && size > 0.99 * radius) {
      radius = std::min(2.0 * radius, kMost);
    } else if (gained < 0.25 * hoped) {
      radius = 0.5 * size;
    }
    // Where it bends less than was thought it does so along other directions, too.
    if (gained > 1.5 * hoped) B *= 0.5;
    x += s;
    here = std::move(there);
    little = gained > end ? 0 : little + 1;
  }
  return {x, here.value};
}

}  // namespace mjdiag
