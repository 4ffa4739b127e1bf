// Machines that no known controller holds.

#include <gtest/gtest.h>

#include "mjdiag/discovery/comparison/comparison.h"
#include "support/arm.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

const Prediction::Sensor& Elbow(const Comparison& comparison) {
  return comparison.prediction.sensors.at(1);
}

TEST(CompareFalling, PredictsTheTrueArmOverATickToItsNoise) {
  const test::Arm arm;
  const Comparison comparison = Compare(arm.machine, test::Arm::Measure(), {});
  ASSERT_TRUE(comparison.falls);
  ASSERT_EQ(comparison.prediction.horizons.size(), 3U);
  EXPECT_DOUBLE_EQ(comparison.prediction.horizons[0], 1e-3);
  EXPECT_DOUBLE_EQ(comparison.prediction.horizons[2], 0.1);
  EXPECT_LT(Elbow(comparison).rms[0], 2.0 * test::Arm::kNoise);
  // The error of a prediction grows.
  EXPECT_GT(Elbow(comparison).rms[2], Elbow(comparison).rms[0]);
}

TEST(CompareFalling, FindsTheFrictionThatIsMissingAtItsJoint) {
  const test::Arm arm;
  const Comparison comparison = Compare(
      arm.machine, test::Arm::Measure({"coulomb_friction@elbow:force=0.3"}), {});
  ASSERT_TRUE(comparison.falls);
  ASSERT_EQ(comparison.missing_force.size(), 2U);
  EXPECT_EQ(comparison.missing_force[1].joint, "elbow");
  EXPECT_EQ(comparison.missing_force[1].unit, "N m");
  // It rests for a part of the time, when friction is anything up to that.
  EXPECT_GT(comparison.missing_force[1].rms, 0.2);
  EXPECT_LT(comparison.missing_force[1].rms, 0.33);
  EXPECT_LT(comparison.missing_force[0].rms, 0.06);
}

TEST(CompareFalling, MissesNextToNothingOnTheTrueArm) {
  const test::Arm arm;
  const Comparison comparison = Compare(arm.machine, test::Arm::Measure(), {});
  ASSERT_TRUE(comparison.falls);
  for (const DisturbanceEstimate& force : comparison.missing_force) {
    EXPECT_LT(force.rms, 0.06) << force.joint;
  }
}

TEST(CompareFalling, LeavesAMachineWithAControllerInItsLoop) {
  const test::Stage stage;
  EXPECT_FALSE(Compare(stage.machine, stage.Measure({}), {}).falls);
}

// It drifts away without leaving what it is at rest: what it is off by then says nothing, but
// the force does.
TEST(CompareFalling, FindsWhatAStageLacksThatDriftsInOpenLoop) {
  const test::Stage stage;
  const Machine open = stage.machine.WithSetup(WithoutControllers(stage.setup()));
  const Comparison comparison =
      Compare(open, stage.Measure({"coulomb_friction@load:force=20"}), {});
  EXPECT_TRUE(comparison.falls);
  ASSERT_EQ(comparison.missing_force.size(), 1U);
  EXPECT_NEAR(comparison.missing_force[0].rms, 20.0, 4.0);
}

// And where nothing is missing it says so, beside a free simulation.
TEST(CompareFalling, FindsNothingMissingFromTheTrueStage) {
  const test::Stage stage;
  const Comparison comparison = Compare(stage.machine, stage.Measure({}), {});
  EXPECT_FALSE(comparison.falls);
  ASSERT_EQ(comparison.missing_force.size(), 1U);
  EXPECT_LT(comparison.missing_force[0].rms, 0.5);
  EXPECT_TRUE(comparison.deviance.has_value());
}

}  // namespace
}  // namespace mjdiag
