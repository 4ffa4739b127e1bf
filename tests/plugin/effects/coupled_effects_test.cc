// Effects that need more of a machine than one joint by itself.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "plugin/effects/effect_bench.h"
#include "support/bonder.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> CandidatesOf(const Effect& effect, const Machine& machine) {
  std::vector<std::string> names;
  for (const Site& site : effect.CandidateSites(
           SiteMap(machine.plant(), machine.linear(), machine.channels()))) {
    names.push_back(site.name);
  }
  return names;
}

Machine Shipped(const char* name) {
  return Machine(ReadSetup(std::string(MJDIAG_SOURCE_DIR "/mjcf/") + name));
}

/// Two masses side by side, each with a motor of its own.
ModelPtr TwoStages() {
  return test::ModelOf(R"(<mujoco><option gravity="0 0 0"/><worldbody>
    <body><joint name="a" type="slide"/><geom size="0.1" mass="2"/></body>
    <body><joint name="b" type="slide"/><geom size="0.1" mass="4"/></body></worldbody>
    <actuator><motor name="ma" joint="a" gear="3"/><motor name="mb" joint="b"/>
    </actuator></mujoco>)");
}

TEST(ForceCoupling, PushesAJointByAShareOfTheForceOfTheOtherMotor) {
  const ModelPtr model = TwoStages();
  const DataPtr data = MakeData(*model);
  ActiveEffects effects(Channels{}, *model,
                        {ParseEffect("force_coupling@b:coefficient=0.1")});
  mj_step1(model.get(), data.get());
  data->ctrl[0] = 5.0;
  data->ctrl[1] = 7.0;
  effects.Act(*model, *data);
  EXPECT_NEAR(data->qfrc_applied[1], 0.1 * 3.0 * 5.0, 1e-12);
  EXPECT_EQ(data->qfrc_applied[0], 0.0);
}

TEST(ForceCoupling, NeedsAMotorOfAnotherJoint) {
  EXPECT_THAT(CandidatesOf(ForceCoupling(), Shipped("servo")), IsEmpty());
  EXPECT_THAT(CandidatesOf(ForceCoupling(), Shipped("emps")), IsEmpty());
  EXPECT_THAT(CandidatesOf(ForceCoupling(), test::Bonder()),
              ElementsAre("X", "Y", "Z"));
}

// At rest, without torque, the weight hangs down, and the encoder reads the offset.
TEST(ZeroOffset, IsWhatAHangingArmReads) {
  const Machine servo = Shipped("servo");
  const Machine off = servo.With(test::With({"zero_offset@shaft:offset=0.03"}));
  EXPECT_NEAR(off.rest()[0], 0.03, 1e-9);
  EXPECT_NEAR(servo.rest()[0], 0.0, 1e-9);
}

TEST(ZeroOffset, LeavesASpringWhereItIsOnTheMachine) {
  const ModelPtr model = test::ModelOf(R"(<mujoco><worldbody>
    <body><joint name="q" type="hinge" stiffness="5" springref="10"/>
    <geom size="0.1" mass="2"/></body></worldbody></mujoco>)");
  const double spring = model->qpos_spring[0] - model->qpos0[0];
  const PlacedEffect effect = ParseEffect("zero_offset@q:offset=0.2");
  ApplyEffect(*model, effect);
  EXPECT_NEAR(model->qpos_spring[0] - model->qpos0[0], spring, 1e-15);
  EXPECT_NEAR(model->qpos0[0], 0.2, 1e-15);
  ZeroOffset().Retract(*model, 0, effect.values);
  EXPECT_NEAR(model->qpos0[0], 0.0, 1e-15);
}

TEST(ZeroOffset, IsLookedForWhereGravityOrASpringTellsTheAngle) {
  EXPECT_THAT(CandidatesOf(ZeroOffset(), Shipped("servo")), ElementsAre("shaft"));
  EXPECT_THAT(CandidatesOf(ZeroOffset(), Shipped("emps")), IsEmpty());
}

// -dF/dq of a pendulum is m g l cos q.
TEST(ZeroOffset, ShowsAlongAMotionAsTheChangeOfGravity) {
  const Machine servo = Shipped("servo");
  ObservedMotion motion;
  motion.sample_time = servo.rates().tick();
  motion.position = Eigen::RowVector3d(0.0, 1.0, -2.0);
  const Site site{"shaft", 0, -1};
  const auto trials =
      ZeroOffset().CandidateRegressors({servo.plant(), servo.linear(), motion, site});
  ASSERT_EQ(trials.size(), 1u);
  for (Eigen::Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(trials[0].signals(k, 0),
                0.49 * 9.81 * 0.1 * std::cos(motion.position(0, k)), 1e-6);
  }
}

TEST(SiteMotion, HasTheBackEmfInTheForceOfItsMotors) {
  const Machine servo = Shipped("servo");
  ObservedMotion motion;
  motion.position = Eigen::RowVector2d(0.3, 0.0);
  motion.velocity = Eigen::RowVector2d(2.0, 0.0);
  motion.inputs = Eigen::RowVector2d(1.5, 0.387 * 3.0);
  const Site site{"shaft", 0, -1};
  const Eigen::VectorXd force =
      SiteMotion{servo.plant(), servo.linear(), motion, site}.motor();
  EXPECT_NEAR(force[0], 0.387 * (1.5 - 0.387 * 2.0) / 4.02, 1e-9);
  EXPECT_NEAR(force[1], 0.387 * 0.387 * 3.0 / 4.02, 1e-9);
}

}  // namespace
}  // namespace mjdiag
