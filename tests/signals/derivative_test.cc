#include "mjdiag/signals/derivative.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

TEST(CentralDifference, IsExactOnParabolas) {
  constexpr double kSampleTime = 0.25;
  const VectorXd t = VectorXd::LinSpaced(9, 0.0, 2.0);
  const VectorXd parabola = (3.0 - 2.0 * t.array() + 5.0 * t.array().square()).matrix();
  const VectorXd slope = (-2.0 + 10.0 * t.array()).matrix();
  EXPECT_LT((CentralDifference(parabola, kSampleTime) - slope).cwiseAbs().maxCoeff(),
            1e-13);
}

TEST(CentralDifference, RefusesTwoSamplesAndNoTime) {
  EXPECT_THROW(CentralDifference(VectorXd::Zero(2), 1.0), InputError);
  EXPECT_THROW(CentralDifference(VectorXd::Zero(3), 0.0), InputError);
}

}  // namespace
}  // namespace mjdiag
