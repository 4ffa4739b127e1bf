#include "support/hidden_cases/dry_friction.h"

#include <gtest/gtest.h>

namespace mjdiag::test {
namespace {

TEST(DryFriction, HoldsWhatItCanHold) {
  const Eigen::Matrix2d A{{2.0, 0.5}, {0.5, 1.0}};
  const Eigen::Vector2d w{0.3, -0.2};
  const Eigen::VectorXd f = DryFriction(A, w, Eigen::Vector2d{1.0, 1.0});
  EXPECT_NEAR((w + A * f).norm(), 0.0, 1e-12);
}

TEST(DryFriction, SlidesWithItsWholeForceAgainstTheMotion) {
  const Eigen::Matrix2d A{{2.0, 0.5}, {0.5, 1.0}};
  const Eigen::Vector2d w{3.0, -0.2};
  const Eigen::VectorXd f = DryFriction(A, w, Eigen::Vector2d{1.0, 1.0});
  EXPECT_EQ(f[0], -1.0);
  EXPECT_GT((w + A * f)[0], 0.0);
  EXPECT_NEAR((w + A * f)[1], 0.0, 1e-12);
}

TEST(DryFriction, IsNoneWhereItsBoundIs0) {
  const Eigen::VectorXd f = DryFriction(
      Eigen::Matrix2d::Identity(), Eigen::Vector2d{1, 1}, Eigen::Vector2d{0.0, 5.0});
  EXPECT_EQ(f[0], 0.0);
  EXPECT_EQ(f[1], -1.0);
}

}  // namespace
}  // namespace mjdiag::test
