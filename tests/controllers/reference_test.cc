#include "mjdiag/controllers/reference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

TEST(DifferentiateReference, IsExactOnAQuartic) {
  // Central differences of a quartic: v is off by T^2/6 p''', a by T^2/12 p''''.
  const double T = 0.01;
  Eigen::VectorXd position(101);
  for (int k = 0; k <= 100; ++k) position[k] = std::pow(k * T - 0.5, 4);
  const AxisReference r = DifferentiateReference("q", position, T);
  EXPECT_EQ(r.axis, "q");
  EXPECT_EQ(r.position, position);
  for (int k = 2; k <= 98; ++k) {
    const double t = k * T - 0.5;
    ASSERT_NEAR(r.velocity[k], 4 * t * t * t + T * T / 6 * 24 * t, 1e-12);
    ASSERT_NEAR(r.acceleration[k], 12 * t * t + T * T / 12 * 24, 1e-10);
    ASSERT_NEAR(r.snap[k], 24.0, 1e-5);
  }
}

TEST(DifferentiateReference, HoldsThePositionAtBothEnds) {
  const double T = 0.5;
  const Eigen::VectorXd position = Eigen::Vector4d(1.0, 1.0, 2.0, 4.0);
  const AxisReference r = DifferentiateReference("q", position, T);
  EXPECT_EQ(r.velocity, Eigen::Vector4d(0.0, 1.0, 3.0, 2.0));
  EXPECT_EQ(r.acceleration, Eigen::Vector4d(0.0, 4.0, 4.0, -8.0));
  // ... 1 1 [1 1 2 4] 4 4 ...: fourth differences over T^4
  EXPECT_EQ(r.snap, 16.0 * Eigen::Vector4d(1.0, -1.0, -3.0, 5.0));
}

TEST(DifferentiateReference, OfFewSamplesIsAtRest) {
  EXPECT_EQ(DifferentiateReference("q", Eigen::VectorXd(), 0.1).snap.size(), 0);
  const AxisReference r =
      DifferentiateReference("q", Eigen::VectorXd::Constant(1, 3.0), 0.1);
  EXPECT_EQ(r.position[0], 3.0);
  EXPECT_EQ(r.velocity[0], 0.0);
  EXPECT_EQ(r.snap[0], 0.0);
}

TEST(DifferentiateReference, RefusesASampleTimeOfZero) {
  EXPECT_THROW(DifferentiateReference("q", Eigen::VectorXd::Zero(3), 0.0), InputError);
}

}  // namespace
}  // namespace mjdiag
