#include "mjdiag/discovery/comparison/derived.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/discovery/comparison/mismatch.h"
#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

constexpr double kStep = 1e-3;
constexpr Eigen::Index kSamples = 4000;
constexpr double kOmega = 2.0 * M_PI * 2.0;  // [rad/s]

Eigen::ArrayXd Phase() {
  return Eigen::ArrayXd::LinSpaced(kSamples, 0.0, (kSamples - 1) * kStep * kOmega);
}

Record Moving(const Eigen::VectorXd& noise) {
  Record record(kStep);
  record.Add({"x", "m", Phase().sin().matrix() + noise});
  record.Add({"u", "V", Phase().cos()});
  return record;
}

CompareSetup Emps() {
  CompareSetup compare;
  compare.low_pass_order = 4;
  compare.low_pass_cutoff = 100.0;
  compare.forces = {{"force", "u", 35.15, "N"}, {"absent", "w", 2.0, "N"}};
  return compare;
}

/// Largest deviation from `expected`, without the ends that filtering cannot know.
double InnerError(const Eigen::VectorXd& values, const Eigen::ArrayXd& expected) {
  const Eigen::ArrayXd error = (values.array() - expected).abs();
  return error.segment(100, kSamples - 200).maxCoeff();
}

TEST(Derived, AreVelocityAccelerationAndForce) {
  const Record derived =
      DeriveChannels(Moving(Eigen::VectorXd::Zero(kSamples)), {"x"}, Emps());
  ASSERT_EQ(derived.channels().size(), 3U);
  // Central differences of a sine are low by (omega T)^2 / 6 = 3e-5.
  EXPECT_LT(InnerError(derived.At("x_velocity").samples, kOmega * Phase().cos()),
            1e-4 * kOmega);
  EXPECT_LT(InnerError(derived.At("x_acceleration").samples,
                       -kOmega * kOmega * Phase().sin()),
            1e-4 * kOmega * kOmega);
  EXPECT_LT(InnerError(derived.At("force").samples, 35.15 * Phase().cos()), 1e-12);
  EXPECT_EQ(derived.At("x_velocity").unit, "m/s");
  EXPECT_EQ(derived.At("x_acceleration").unit, "m/s^2");
  EXPECT_EQ(derived.At("force").unit, "N");
}

TEST(Derived, VelocityIsLowPassedFirst) {
  const Record noisy = Moving(GaussianNoise(kSamples, 1e-4, 1));
  CompareSetup raw = Emps();
  raw.low_pass_order = 0;
  const auto error = [&](const CompareSetup& compare) {
    return InnerError(DeriveChannels(noisy, {"x"}, compare).At("x_velocity").samples,
                      kOmega * Phase().cos());
  };
  EXPECT_LT(error(Emps()), 0.5 * error(raw));
}

TEST(Derived, MismatchIsRelativeAndLeavesOutTheStart) {
  Record measured(kStep);
  Record simulated(kStep);
  Eigen::VectorXd y = Eigen::VectorXd::Constant(100, 2.0);
  Eigen::VectorXd yhat = Eigen::VectorXd::Constant(100, 1.9);
  yhat.head(10).setConstant(50.0);
  measured.Add({"force", "N", y});
  simulated.Add({"force", "N", yhat});
  const auto mismatch = MeasureDerived(measured, simulated, 10);
  ASSERT_EQ(mismatch.size(), 1U);
  EXPECT_EQ(mismatch[0].name, "force");
  EXPECT_EQ(mismatch[0].unit, "N");
  EXPECT_NEAR(mismatch[0].rms, 0.1, 1e-12);
  EXPECT_NEAR(mismatch[0].relative_error_percent, 5.0, 1e-10);
}

}  // namespace
}  // namespace mjdiag
