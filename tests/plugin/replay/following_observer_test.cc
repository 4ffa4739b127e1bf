// An observer on machines that leave their rest.

#include <gtest/gtest.h>

#include "mjdiag/plugin/replay/motion_path.h"
#include "mjdiag/signals/error.h"
#include "plugin/replay/replay.h"
#include "support/arm.h"
#include "support/bonder.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// An arm that was measured, beside itself.
struct Followed {
  test::Arm arm;
  MeasuredRun run;
  VectorXd noise = VectorXd::Constant(2, test::Arm::kNoise);

  explicit Followed(const Record& measured)
      : run(ToMeasuredRun(arm.setup(), measured)) {}
  Observer At(double bandwidth) const {
    return DesignObserver(arm.machine, run, noise, bandwidth);
  }
  Observer AtRest(double bandwidth) const {
    const Rates& rates = arm.machine.rates();
    return DesignObserver(arm.machine.linear(), rates.step(), rates.substeps, noise,
                          bandwidth);
  }
  /// Innovations over those of noise alone, root mean square, behind the first fifth.
  double Rest(const Observer& observer) const {
    const MatrixXd e = observer.innovation_sd.cwiseInverse().asDiagonal() *
                       FollowRun(arm.machine, {}, run, observer, false).innovations;
    const Index n = e.cols() - e.cols() / 5;
    return e.rightCols(n).norm() / std::sqrt(static_cast<double>(e.rows() * n));
  }
};

TEST(FollowingObserver, StaysBesideAnArmThatTheGainOfItsRestLoses) {
  const Followed followed(test::Arm::Measure());
  // Slow enough that gravity is more than what pulls the observer back.
  constexpr double kSlow = 0.5;
  ASSERT_TRUE(followed.At(kSlow).following);
  double at_rest = 1e9;
  try {
    at_rest = followed.Rest(followed.AtRest(kSlow));
  } catch (const NumericalError&) {
    // Lost altogether.
  }
  EXPECT_GT(at_rest, 100.0 * followed.Rest(followed.At(kSlow)));
  // Steps of the model are four times as long as the machine's: a faster one forgets that.
  EXPECT_LT(followed.Rest(followed.At(20.0)), 2.0);
}

// Bound: of some thousand coloured values the spread is known to some percent.
TEST(FollowingObserver, KnowsTheSpreadOfInnovationsOfATrueModel) {
  const Followed followed(test::Arm::Measure({}, 1.0, 2));
  EXPECT_NEAR(followed.Rest(followed.At(30.0)), 1.0, 0.06);
}

TEST(FollowingObserver, KnowsTheirColour) {
  const Followed followed(test::Arm::Measure({}, 1.0, 2));
  const Observer observer = followed.At(60.0);
  const MatrixXd e =
      FollowRun(followed.arm.machine, {}, followed.run, observer, false).innovations;
  const VectorXd one = e.row(0).tail(2500);
  const VectorXd noise = NoiseCorrelation(observer, 0, 3);
  for (Index l = 1; l <= 3; ++l) {
    const double seen = one.head(2500 - l).dot(one.tail(2500 - l)) / one.squaredNorm();
    EXPECT_NEAR(seen, noise[l - 1], 4.0 / std::sqrt(2500.0)) << l;
  }
  EXPECT_LT(noise[0], -0.05);
}

TEST(FollowingObserver, IsThatOfTheRestToTheDigitWhereTheMachineStaysNearIt) {
  const test::Stage stage;
  const test::Replay replay(stage.machine, stage.Measure({}));
  const Observer observer = DesignObserver(
      stage.machine, replay.run, replay.observer.noise_sd, replay.observer.bandwidth);
  EXPECT_FALSE(observer.following);
  EXPECT_EQ(observer.L, replay.observer.L);
  EXPECT_EQ(observer.innovation_sd, replay.observer.innovation_sd);
  EXPECT_EQ(FollowRun(stage.machine, {}, replay.run, observer, false).innovations,
            replay.Follow({}).innovations);
}

TEST(FollowingObserver, StaysAtRestOnTheBonder) {
  const Machine bonder = test::Bonder();
  const Record measured = Simulate(bonder, DefaultMotion(bonder.setup()), {});
  const MeasuredRun run = ToMeasuredRun(bonder.setup(), measured);
  EXPECT_TRUE(RestGainHolds(bonder, run, 25.0 / measured.duration()));
}

TEST(FollowingObserver, BeginsInMotion) {
  const Record measured = test::Arm::Measure({}, 0.0);
  const Followed followed(measured.Slice(400, 1600));
  const MatrixXd e =
      FollowRun(followed.arm.machine, {}, followed.run, followed.At(8.0), false)
          .innovations;
  // At rest it would be behind by 4 mrad after the first tick.
  EXPECT_LT(e.leftCols(10).cwiseAbs().maxCoeff(), 2e-4);
}

// The first order along the motion: what a force that is missing does to the readings.
TEST(FollowingObserver, HasTheFirstOrderOfAMissingForceAlongTheMotion) {
  const Followed followed(test::Arm::Measure({}, 0.0));
  const Observer observer = followed.At(20.0);
  ErrorDynamics dynamics(observer, 1);
  const Track without =
      FollowRun(followed.arm.machine, {}, followed.run, observer, dynamics);
  const Changes change = test::With({"viscous_friction@elbow:coefficient=0.01"});
  const Track with =
      FollowRun(followed.arm.machine, change, followed.run, observer, true);
  const MatrixXd force = 0.01 * with.velocity.row(1).transpose();
  const VectorXd predicted = dynamics.OfForces(VectorXd::Unit(2, 1), force);
  const MatrixXd scaled = observer.innovation_sd.cwiseInverse().asDiagonal() *
                          (with.innovations - without.innovations);
  const VectorXd seen = scaled.reshaped();
  EXPECT_LT((predicted - seen).norm(), 0.02 * seen.norm());
}

TEST(FollowingObserver, IsTheSameForAnyNumberOfThreads) {
  const Followed followed(test::Arm::Measure());
  const Observer once = followed.At(8.0);
  const Observer again = followed.At(8.0);
  EXPECT_EQ(once.L, again.L);
  EXPECT_EQ(once.following->L.back(), again.following->L.back());
}

TEST(MotionOfReadings, HasPositionsVelocitiesAndAccelerations) {
  test::Arm arm;
  MeasuredRun run;
  run.sample_time = 1e-3;
  const VectorXd t = VectorXd::LinSpaced(1000, 0.0, 0.999);
  run.outputs.resize(2, 1000);
  run.outputs.row(0) = (3.0 * t).array().sin();
  run.outputs.row(1) = (5.0 * t).array().cos();
  run.inputs = MatrixXd::Zero(2, 1000);
  const auto points = MotionOfReadings(arm.machine, run, {500});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].position[0], std::sin(1.5), 1e-3);
  EXPECT_NEAR(points[0].velocity[0], 3.0 * std::cos(1.5), 1e-2);
  EXPECT_NEAR(points[0].acceleration[1], -25.0 * std::cos(2.5), 0.3);
}

}  // namespace
}  // namespace mjdiag
