#include "mjdiag/plugin/plant/rest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "support/bonder.h"
#include "support/small_plant.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;
using test::SmallPlant;

/// Largest acceleration of MuJoCo itself in a configuration, dry friction off.
double AccelerationAt(const mjModel& plant, const VectorXd& qpos) {
  const DataPtr data = MakeData(plant);
  VectorXd::Map(data->qpos, plant.nq) = qpos;
  mj_forward(&plant, data.get());
  return VectorXd::Map(data->qacc, plant.nv).cwiseAbs().maxCoeff();
}

/// Height of all masses times their weight.
double PotentialEnergy(const mjModel& plant, const VectorXd& qpos) {
  const DataPtr data = MakeData(plant);
  VectorXd::Map(data->qpos, plant.nq) = qpos;
  mj_forward(&plant, data.get());
  double energy = 0.0;
  for (int body = 1; body < plant.nbody; ++body) {
    energy += 9.81 * plant.body_mass[body] * data->xipos[3 * body + 2];
  }
  return energy;
}

TEST(Rest, OfTheBonderIsItsReferenceConfiguration) {
  const RestPose rest = FindRest(test::Bonder().plant());
  EXPECT_LT(rest.qpos.cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_TRUE(rest.rests);
  EXPECT_TRUE(rest.stable);
}

TEST(Rest, OfAHangingMassIsWhereSpringAndWeightBalance) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="z" type="slide" axis="0 0 1" stiffness="400"/>
      <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/>
    </body></worldbody>)");
  EXPECT_NEAR(FindRest(*plant).qpos[0], -2.0 * 9.81 / 400.0, 1e-13);
}

TEST(Rest, OfASaggingPendulumBalancesTorques) {
  // k a = m g l cos a with m g l / k = 3.9: the weight outdoes the spring so far that
  // full Newton steps would end at another turn of the pendulum.
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint type="hinge" axis="0 1 0" stiffness="1"/>
      <inertial pos="0.2 0 0" mass="2" diaginertia="1e-3 1e-3 1e-3"/>
    </body></worldbody>)");
  const double angle = FindRest(*plant).qpos[0];
  EXPECT_NEAR(angle, 2.0 * 9.81 * 0.2 * std::cos(angle), 1e-12);
  EXPECT_NEAR(angle, 1.25, 0.01);
}

std::string LinkDrawnAt(double elevation) {
  return R"(<worldbody><body euler="0 )" + std::to_string(-elevation) + R"( 0">
      <joint name="hinge" axis="0 1 0"/>
      <inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body></worldbody>)";
}

TEST(Rest, OfALinkThatIsDrawnAnywhereAboveIsHanging) {
  for (const double elevation : {0.0, 0.5, 1.2, 1.5, -1.0, 2.5}) {
    const RestPose rest = FindRest(*SmallPlant(LinkDrawnAt(elevation)));
    EXPECT_TRUE(rest.rests && rest.stable) << elevation;
    EXPECT_NEAR(std::remainder(rest.qpos[0] - elevation - std::numbers::pi / 2.0,
                               2.0 * std::numbers::pi),
                0.0, 1e-6)
        << elevation;
  }
}

TEST(Rest, OfALinkThatIsDrawnBalancedUprightIsHanging) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0.2" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body></worldbody>)");
  const RestPose rest = FindRest(*plant);
  EXPECT_NEAR(std::abs(rest.qpos[0]), std::numbers::pi, 1e-9);
  const RestPose upright = PoseAt(*plant, VectorXd::Zero(1));
  EXPECT_TRUE(upright.rests);
  EXPECT_FALSE(upright.stable);
  const RestPose held = FindRest(*plant, true);
  EXPECT_EQ(held.qpos[0], 0.0);
  EXPECT_TRUE(held.rests);
  EXPECT_FALSE(held.stable);
}

/// An arm of six joints, of the size and the axes of a UR10e.
const std::string kArm = R"(<worldbody>
  <body name="l1" pos="0 0 0.18"><joint axis="0 0 1" armature="3.7"/>
   <inertial pos="0 0 0" mass="7.8" diaginertia="0.03 0.03 0.02"/>
   <body name="l2" pos="0 0.18 0" euler="0 1.5707963 0"><joint axis="0 1 0" armature="3.7"/>
    <inertial pos="0 0 0.31" mass="12.9" diaginertia="0.42 0.42 0.04"/>
    <body name="l3" pos="0 -0.14 0.61"><joint axis="0 1 0" armature="1"/>
     <inertial pos="0 0 0.29" mass="3.9" diaginertia="0.11 0.11 0.01"/>
     <body name="l4" pos="0 0 0.57" euler="0 1.5707963 0"><joint axis="0 1 0" armature="0.07"/>
      <inertial pos="0 0.14 0" mass="2" diaginertia="0.005 0.005 0.005"/>
      <body name="l5" pos="0 0.14 0"><joint axis="0 0 1" armature="0.2"/>
       <inertial pos="0 0 0.12" mass="2" diaginertia="0.005 0.005 0.005"/>
       <body name="l6" pos="0 0 0.12"><joint axis="0 1 0" armature="0.4"/>
        <inertial pos="0 0.09 0" mass="0.2" diaginertia="2e-4 2e-4 2e-4"/>
  </body></body></body></body></body></body></worldbody>)";

/// Draws the bodies of a chain of hinges turned by these angles, coordinates still 0.
void DrawTurned(const VectorXd& angles, mjModel& plant) {
  for (int joint = 0; joint < plant.njnt; ++joint) {
    mjtNum turn[4];
    mjtNum drawn[4];
    mjtNum* quat = RowOf(plant.body_quat, 4, plant.jnt_bodyid[joint]);
    mju_axisAngle2Quat(turn, RowOf(plant.jnt_axis, 3, joint), angles[joint]);
    mju_mulQuat(drawn, quat, turn);
    mju_copy(quat, drawn, 4);
  }
  const DataPtr data = MakeData(plant);
  mj_setConst(&plant, data.get());
}

TEST(Rest, OfAnArmThatIsDrawnInTwoHundredWaysIsFoundInAll) {
  const ModelPtr arm = SmallPlant(kArm);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> angle(-3.1, 3.1);
  for (int trial = 0; trial < 200; ++trial) {
    const ModelPtr drawn = CopyModel(*arm);
    VectorXd angles(drawn->nv);
    for (double& value : angles) value = angle(generator);
    DrawTurned(angles, *drawn);
    const RestPose rest = FindRest(*drawn);
    ASSERT_TRUE(rest.rests) << trial;
    EXPECT_TRUE(rest.stable) << trial;
    EXPECT_LT(AccelerationAt(*drawn, rest.qpos), 1e-6) << trial;
    EXPECT_LT(PotentialEnergy(*drawn, rest.qpos),
              PotentialEnergy(*drawn, VectorXd::Zero(drawn->nq)) + 1e-9)
        << trial;
    // About the vertical nothing pulls.
    EXPECT_LT(std::abs(rest.qpos[0]), 1e-9) << trial;
  }
}

TEST(Rest, LeavesJointsThatCarryNothingWhereTheyAreDrawn) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body euler="0 0.7 0">
      <joint name="swing" axis="0 1 0"/>
      <inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      <body pos="0.2 0 0" euler="0 0 0.3"><joint name="wheel" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="1" diaginertia="0.02 0.01 0.01"/></body>
    </body></worldbody>)");
  const RestPose rest = FindRest(*plant);
  EXPECT_TRUE(rest.rests && rest.stable);
  EXPECT_NEAR(rest.qpos[0], std::numbers::pi / 2.0 - 0.7, 1e-9);
  EXPECT_LT(std::abs(rest.qpos[1]), 1e-12);
}

TEST(Rest, OfWhatFallsIsTheConfigurationDrawnWithWhatHoldsIt) {
  const ModelPtr plant = SmallPlant(test::kQuadrotor);
  const RestPose rest = FindRest(*plant);
  EXPECT_FALSE(rest.rests);
  EXPECT_EQ(rest.qpos, VectorXd::Map(plant->qpos0, plant->nq));
  EXPECT_NEAR(rest.holding_force[2], 1.3 * 9.81, 1e-12);
  EXPECT_LT(rest.holding_force.norm(), 1.3 * 9.81 + 1e-9);
}

TEST(Rest, OfAFootOnAFloorIsHeldByTheFloor) {
  const ModelPtr plant = SmallPlant(test::kHopper);
  const RestPose rest = FindRest(*plant);
  EXPECT_TRUE(rest.rests && rest.stable);
  EXPECT_LT(AccelerationAt(*plant, rest.qpos), 1e-6);
  EXPECT_NEAR(rest.qpos[1], 4.0 * 9.81 / 4000.0, 1e-9);
}

TEST(Rest, OfABoxThatIsDrawnInTheAirIsOnTheFloor) {
  const ModelPtr plant = SmallPlant(R"(<worldbody>
      <geom type="plane" size="1 1 .1"/>
      <body pos="0 0 1" euler="0.2 0.1 0.3"><freejoint/>
        <geom type="box" size="0.1 0.15 0.05" mass="1"/></body></worldbody>)");
  const RestPose rest = FindRest(*plant);
  EXPECT_TRUE(rest.rests && rest.stable);
  EXPECT_NEAR(rest.qpos[2], 0.05, 5e-3);
  EXPECT_LT(AccelerationAt(*plant, rest.qpos), 1e-6);
}

TEST(Rest, OfABoxOnASlopeIsHeldByFrictionIfThereIsEnough) {
  const auto box_on_slope = [](const std::string& friction) {
    return SmallPlant(R"(<default><geom friction=")" + friction + R"( 0.005 0.0001"/>
      </default><worldbody><geom type="plane" size="5 5 .1" euler="0 0.2 0"/>
      <body pos="0 0 0.06" euler="0 0.2 0"><freejoint/>
        <geom type="box" size="0.1 0.1 0.05" mass="1"/></body></worldbody>)");
  };
  EXPECT_TRUE(FindRest(*box_on_slope("0.8")).rests);
  const RestPose slides = FindRest(*box_on_slope("0.05"));
  EXPECT_FALSE(slides.rests);
  EXPECT_NEAR(slides.holding_force[2], 9.81, 1e-9);
}

TEST(Rest, OfTiedSlidesIsWhereTheEqualityHoldsThem) {
  // One of them hangs on a spring, the other one moves half as much.
  const ModelPtr plant = SmallPlant(R"(<worldbody>
    <body><joint name="a" type="slide" axis="0 0 1" stiffness="1000"/>
      <inertial pos="0 0 0" mass="4" diaginertia=".1 .1 .1"/></body>
    <body pos="1 0 0"><joint name="b" type="slide" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="2" diaginertia=".1 .1 .1"/></body>
  </worldbody>
  <equality><joint joint1="b" joint2="a" polycoef="0 0.5 0 0 0"
    solref="0.002 1"/></equality>)");
  const RestPose rest = FindRest(*plant);
  EXPECT_TRUE(rest.rests && rest.stable);
  EXPECT_LT(AccelerationAt(*plant, rest.qpos), 1e-6);
  EXPECT_NEAR(rest.qpos[0], -(4.0 + 0.5 * 2.0) * 9.81 / 1000.0, 1e-5);
  EXPECT_NEAR(rest.qpos[1], 0.5 * rest.qpos[0], 1e-3);
}

TEST(Rest, OfALinkWithALimitIsAtTheLimit) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="hinge" axis="0 1 0" range="-0.5 0.4"/>
      <inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body></worldbody>)");
  const RestPose rest = FindRest(*plant);
  EXPECT_TRUE(rest.rests && rest.stable);
  EXPECT_NEAR(rest.qpos[0], 0.4, 0.05);
  EXPECT_LT(AccelerationAt(*plant, rest.qpos), 1e-6);
}

TEST(Rest, OfAServoIsWhereItsBiasHoldsTheWeight) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="hinge" axis="0 1 0"/>
      <inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body></worldbody><actuator><position joint="hinge" kp="50"/></actuator>)");
  const double angle = FindRest(*plant).qpos[0];
  EXPECT_NEAR(50.0 * angle, 1.0 * 9.81 * 0.2 * std::cos(angle), 1e-11);
}

TEST(Rest, OfABallJointHangs) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="ball" type="ball"/>
      <inertial pos="0.2 0.1 0.3" mass="1" diaginertia="0.01 0.02 0.03"/>
    </body></worldbody>)");
  const RestPose rest = FindRest(*plant);
  EXPECT_TRUE(rest.rests && rest.stable);
  EXPECT_LT(AccelerationAt(*plant, rest.qpos), 1e-6);
  EXPECT_NEAR(PotentialEnergy(*plant, rest.qpos), -9.81 * std::sqrt(0.14), 1e-9);
}

TEST(Rest, OfAJointThatIsDrivenOnAndOnIsNone) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="wheel" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body></worldbody><actuator><general joint="wheel" biastype="affine"
      biasprm="0.5 0 0"/></actuator>)");
  const RestPose rest = FindRest(*plant);
  EXPECT_FALSE(rest.rests);
  EXPECT_NEAR(rest.holding_force[0], -0.5, 1e-12);
}

}  // namespace
}  // namespace mjdiag
