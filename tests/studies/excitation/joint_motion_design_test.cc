#include "mjdiag/studies/excitation/joint_motion_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <random>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/excitation/fourier_motion.h"
#include "mjdiag/studies/excitation/inertial_regressor.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(FourierMotion, BeginsAndEndsAtRestAndKeepsItsLimits) {
  const AxisLimits limits{
      .lowest = -0.5, .highest = 1.5, .velocity = 2.0, .acceleration = 9.0};
  const FourierMotion series(4.0, 5, {limits, limits}, 4001);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    VectorXd drawn(series.parameters());
    for (double& value : drawn) value = normal(random);
    const JointMotion motion = series.At(drawn);
    const double tick = 4.0 / 4000.0;
    for (const Eigen::Index end : {Eigen::Index{0}, Eigen::Index{4000}}) {
      EXPECT_LT(motion.velocity.col(end).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LT(motion.acceleration.col(end).cwiseAbs().maxCoeff(), 1e-9);
    }
    EXPECT_GE(motion.position.minCoeff(), limits.lowest - 2e-3);
    EXPECT_LE(motion.position.maxCoeff(), limits.highest + 2e-3);
    EXPECT_LE(motion.velocity.cwiseAbs().maxCoeff(), 1.01 * limits.velocity);
    EXPECT_LE(motion.acceleration.cwiseAbs().maxCoeff(), 1.01 * limits.acceleration);
    // Velocities and accelerations are those of the positions.
    const MatrixXd middle =
        (motion.position.rightCols(3999) - motion.position.leftCols(3999)) /
        (2.0 * tick);
    EXPECT_LT((middle - motion.velocity.middleCols(1, 3999)).cwiseAbs().maxCoeff(),
              1e-4);
    const MatrixXd change =
        (motion.velocity.rightCols(3999) - motion.velocity.leftCols(3999)) /
        (2.0 * tick);
    EXPECT_LT((change - motion.acceleration.middleCols(1, 3999)).cwiseAbs().maxCoeff(),
              2e-3);
  }
}

class ExcitedArm : public ::testing::Test {
 protected:
  static JointMotionOptions Short() {
    JointMotionOptions options;
    options.rounds = 60;
    return options;
  }
  static const JointMotionDesign& Design() {
    static const JointMotionDesign design = DesignJointMotion(
        Arm().machine, ToMeasuredRun(Arm().setup(), test::Arm::Measure()), Short());
    return design;
  }
  static const test::Arm& Arm() {
    static const test::Arm arm;
    return arm;
  }
};

TEST_F(ExcitedArm, TellsItsNumbersApartBetterWithinTheSameLimits) {
  EXPECT_GT(Design().Gain(), 1.0);
  for (std::size_t j = 0; j < 2; ++j) {
    const AxisLimits &limits = Design().limits[j], &peaks = Design().peaks[j];
    EXPECT_GE(peaks.lowest, limits.lowest - 0.01);
    EXPECT_LE(peaks.highest, limits.highest + 0.01);
    EXPECT_LE(peaks.velocity, 1.02 * limits.velocity);
    EXPECT_LE(peaks.acceleration, 1.02 * limits.acceleration);
    EXPECT_LE(peaks.force, 1.02 * limits.force);
  }
}

// Of a planar arm with two joints: an inertia and a first moment across of each link (two
// each), and three numbers of each joint, less those that the same motion cannot tell: the
// rotor of the shoulder and the inertia of the upper arm, the moment of the upper arm and the
// mass of the fore arm.
TEST_F(ExcitedArm, HasTheNumbersThatAnArmOfTwoLinksCanTell) {
  EXPECT_EQ(Design().numbers.size(), 2u * 3u + 6u - 1u)
      << ::testing::PrintToString(Design().numbers);
}

// Least squares on forces with that noise: 400 fits, whose standard deviations are known to
// 1 / sqrt(800) of themselves; 4.5 times that for all numbers together.
TEST_F(ExcitedArm, LeastSquaresComesToThePromisedDeviations) {
  InertialRegressor regressor(Arm().machine.plant());
  const JointMotionDesign& design = Design();
  const double tick = design.sample_time;
  const auto step =
      static_cast<Eigen::Index>(std::lround(0.5 / (design.bandwidth * tick)));
  std::vector<MatrixXd> rows;
  for (Eigen::Index k = 1; k + 1 < design.position.cols(); k += step) {
    const VectorXd before = design.position.col(k - 1), now = design.position.col(k),
                   behind = design.position.col(k + 1);
    rows.push_back(regressor.At(now, (behind - before) / (2.0 * tick),
                                (behind - 2.0 * now + before) / (tick * tick)));
  }
  const Eigen::Index count = std::ssize(design.numbers);
  MatrixXd W(2 * std::ssize(rows), count);
  for (Eigen::Index k = 0; k < std::ssize(rows); ++k) {
    for (Eigen::Index c = 0; c < count; ++c) {
      const auto at = std::ranges::find(regressor.names(),
                                        design.numbers[static_cast<std::size_t>(c)]) -
                      regressor.names().begin();
      for (Eigen::Index j = 0; j < 2; ++j)
        W(2 * k + j, c) = rows[static_cast<std::size_t>(k)](j, at) / design.noise[j];
    }
  }
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(W);
  VectorXd square = VectorXd::Zero(count);
  constexpr int kFits = 400;
  for (int fit = 0; fit < kFits; ++fit) {
    VectorXd noise(W.rows());
    for (double& value : noise) value = normal(random);
    square += VectorXd(qr.solve(noise)).cwiseAbs2();
  }
  const VectorXd ratio = (square / kFits).cwiseSqrt().cwiseQuotient(design.after);
  EXPECT_NEAR(ratio.maxCoeff(), 1.0, 0.16) << ratio.transpose();
  EXPECT_NEAR(ratio.minCoeff(), 1.0, 0.16) << ratio.transpose();
}

TEST_F(ExcitedArm, RefusesLimitsOfNoJointAndThoseThatNothingKeeps) {
  const MeasuredRun run = ToMeasuredRun(Arm().setup(), test::Arm::Measure());
  const auto designed = [&](const std::string& joint, AxisLimits limits) {
    JointMotionOptions options = Short();
    options.limits = {{joint, limits}};
    DesignJointMotion(Arm().machine, run, options);
  };
  EXPECT_THAT([&] { designed("wrist", {}); },
              ThrowsMessage<InputError>(HasSubstr("shoulder, elbow")));
  EXPECT_THAT([&] { designed("elbow", {.snap = 2.0}); },
              ThrowsMessage<InputError>(HasSubstr("jerk or snap")));
  EXPECT_THAT([&] { designed("elbow", {.lowest = 2.0, .highest = 1.0}); },
              ThrowsMessage<InputError>(HasSubstr("lowest < highest")));
  EXPECT_THAT(
      [&] { designed("shoulder", {.lowest = 1.4, .highest = 1.6, .force = 1.0}); },
      ThrowsMessage<InputError>(HasSubstr("no motion was found")));
}

}  // namespace
}  // namespace mjdiag
