#include "mjdiag/discovery/screening/bounded_regression.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const Eigen::ArrayX<bool> kNone = Eigen::ArrayX<bool>::Constant(3, false);

/// Columns and a residual of normal numbers.
struct Case {
  MatrixXd phi = MatrixXd::Zero(20, 3);
  VectorXd residual = VectorXd::Zero(20);

  explicit Case(std::uint64_t seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    for (double& value : phi.reshaped()) value = normal(engine);
    for (double& value : residual) value = normal(engine);
  }
  MatrixXd G() const { return phi.transpose() * phi; }
  VectorXd b() const { return phi.transpose() * residual; }
  double GainOf(const VectorXd& amplitude) const {
    return residual.squaredNorm() - (residual - phi * amplitude).squaredNorm();
  }
};

TEST(RegressBounded, WithoutBoundsIsLeastSquares) {
  const Case one(1);
  const auto found = RegressBounded(one.G(), one.b(), {}, kNone);
  ASSERT_TRUE(found);
  const VectorXd expected = one.phi.householderQr().solve(one.residual);
  EXPECT_TRUE(found->amplitude.isApprox(expected, 1e-9));
  EXPECT_NEAR(found->gain, one.GainOf(expected), 1e-9);
}

// No gradient into what is allowed is left, and none across a bound that is not met
// (Karush, Kuhn and Tucker): no other amplitudes that are allowed take more away.
TEST(RegressBounded, TakesTheMostAwayThatItsBoundsAllow) {
  const VectorXd least = Eigen::Vector3d(0.0, -0.1, 0.0);
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Case one(seed);
    const auto found = RegressBounded(one.G(), one.b(), least, kNone);
    if (!found) {
      EXPECT_LE(one.b().maxCoeff(), 1e-12) << seed;  // nothing but what pushes
      continue;
    }
    const VectorXd& a = found->amplitude;
    const VectorXd rising = one.b() - one.G() * a;
    for (Index i = 0; i < 3; ++i) {
      EXPECT_GE(a[i], least[i]) << seed;
      const bool is_held = a[i] == least[i];
      held += is_held;
      if (is_held) {
        EXPECT_LE(rising[i], 1e-9) << seed;
      } else {
        EXPECT_NEAR(rising[i], 0.0, 1e-9) << seed;
      }
    }
    EXPECT_NEAR(found->gain, one.GainOf(a), 1e-9);
  }
  EXPECT_GT(held, 20);
}

TEST(RegressBounded, LeavesOutWhatIsExplainedAndWhatIsTheSameAsAnother) {
  Case one(3);
  one.phi.col(2) = 2.0 * one.phi.col(1);
  Eigen::ArrayX<bool> explained = kNone;
  explained[0] = true;
  const auto found = RegressBounded(one.G(), one.b(), {}, explained);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->amplitude[0], 0.0);
  EXPECT_EQ((found->amplitude.tail(2).array() == 0.0).count(), 1);
  const VectorXd column = one.phi.col(1);
  EXPECT_NEAR(found->gain, std::pow(column.dot(one.residual), 2) / column.squaredNorm(),
              1e-9);
}

TEST(RegressBounded, FindsNothingWhereAllWouldPush) {
  const Case one(5);
  const MatrixXd phi = one.phi.col(0) * (one.b()[0] > 0.0 ? -1.0 : 1.0);
  EXPECT_FALSE(RegressBounded(phi.transpose() * phi, phi.transpose() * one.residual,
                              VectorXd::Zero(1),
                              Eigen::ArrayX<bool>::Constant(1, false)));
}

}  // namespace
}  // namespace mjdiag
