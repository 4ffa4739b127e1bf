#include "mjdiag/plugin/replay/bounded_descent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What a step within a box has to fulfil to be the least (Karush, Kuhn, Tucker): no slope
/// where it is free, one that pushes outwards where it is held.
double LeftToGain(const MatrixXd& B, const VectorXd& g, const VectorXd& low,
                  const VectorXd& high, const VectorXd& s) {
  const VectorXd slope = g + B * s;
  double left = 0.0;
  for (Index i = 0; i < s.size(); ++i) {
    const bool at_low = s[i] <= low[i];
    const bool at_high = s[i] >= high[i];
    if (!at_high) left = std::max(left, -slope[i]);
    if (!at_low) left = std::max(left, slope[i]);
  }
  return left;
}

TEST(BoundedDescent, AStepIsTheLeastOfItsParabolaWithinTheBox) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    constexpr Index n = 12;
    const auto draw = [&] { return normal(random); };
    const MatrixXd root = MatrixXd::NullaryExpr(n, n, draw);
    const MatrixXd B = root * root.transpose() + 0.1 * MatrixXd::Identity(n, n);
    const VectorXd g = 3.0 * VectorXd::NullaryExpr(n, draw);
    // Some bounds are where it stands.
    VectorXd low = -VectorXd::NullaryExpr(n, draw).cwiseAbs();
    const VectorXd high = VectorXd::NullaryExpr(n, draw).cwiseAbs();
    low[trial % n] = 0.0;
    const VectorXd s = LeastWithin(B, g, low, high);
    ASSERT_TRUE((s.array() >= low.array()).all() && (s.array() <= high.array()).all());
    ASSERT_LT(LeftToGain(B, g, low, high, s), 1e-9) << "trial " << trial;
  }
}

/// Rosenbrock's valley, whose end is 1 everywhere.
Sloped Valley(const VectorXd& x) {
  Sloped at{0.0, VectorXd::Zero(x.size()), {}};
  for (Index i = 0; i + 1 < x.size(); ++i) {
    const double off = x[i + 1] - x[i] * x[i];
    at.value += 100.0 * off * off + std::pow(1.0 - x[i], 2);
    at.slope[i] += -400.0 * off * x[i] - 2.0 * (1.0 - x[i]);
    at.slope[i + 1] += 200.0 * off;
  }
  return at;
}

TEST(BoundedDescent, FollowsACurvedValleyToItsEnd) {
  const VectorXd wide = VectorXd::Constant(2, 10.0);
  VectorXd x(2);
  x << -1.2, 1.0;
  const Least least = DescendWithin(Valley, x, -wide, wide, 1e-8);
  EXPECT_LT(least.value, 1e-6);
}

// The bound is where the valley is least behind it: x0 = 0.5 and x1 = 0.25.
TEST(BoundedDescent, EndsAtABoundThatItMeets) {
  VectorXd lower(2), upper(2), x(2);
  lower << -10.0, -10.0;
  upper << 0.5, 10.0;
  x << -1.2, 1.0;
  const Least least = DescendWithin(Valley, x, lower, upper, 1e-8);
  EXPECT_EQ(least.x[0], 0.5);
  EXPECT_NEAR(least.x[1], 0.25, 1e-4);
}

// A step onto what has no value is taken back, and shorter ones follow.
TEST(BoundedDescent, StepsBackFromWhatHasNoValue) {
  const auto barred = [](const VectorXd& x) {
    Sloped at{x[0] - 4.0 * std::log(x[0]), VectorXd(1), {}};
    at.slope << 1.0 - 4.0 / x[0];
    if (!(x[0] > 0.0)) at.value = std::numeric_limits<double>::infinity();
    return at;
  };
  const VectorXd wide = VectorXd::Constant(1, 100.0);
  const Least least =
      DescendWithin(barred, VectorXd::Constant(1, 60.0), -wide, wide, 1e-9);
  EXPECT_NEAR(least.x[0], 4.0, 1e-3);
}

// Of what is a parabola, and whose curvature is known, one step is enough; the next tells
// that it was.
TEST(BoundedDescent, AKnownCurvatureSavesItsSteps) {
  int asked = 0;
  const VectorXd bends = VectorXd::LinSpaced(6, 1.0, 1000.0);
  const auto parabola = [&](const VectorXd& x) {
    ++asked;
    Sloped at{0.5 * x.dot(bends.cwiseProduct(x)), bends.cwiseProduct(x), {}};
    at.curvature = bends.asDiagonal();
    return at;
  };
  const VectorXd wide = VectorXd::Constant(6, 10.0);
  const Least least = DescendWithin(parabola, VectorXd::Ones(6), -wide, wide, 1e-9);
  EXPECT_LT(least.value, 1e-12);
  EXPECT_LE(asked, 4);
}

}  // namespace
}  // namespace mjdiag
