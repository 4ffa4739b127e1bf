#include "mjdiag/plugin/plant/start_state.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/signals/error.h"
#include "support/small_plant.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;
using test::SmallPlant;

VectorXd Drawn(const mjModel& plant) { return VectorXd::Map(plant.qpos0, plant.nq); }

const std::string kLink = R"(<worldbody><body name="arm">
    <joint name="arm" axis="0 1 0" range="-3 3"/>
    <inertial pos="0 0 -.1" mass=".5" diaginertia="1e-3 1e-3 1e-3"/>
    <site name="tip" pos="0 0 -.2"/>
  </body></worldbody>
  <sensor><jointpos name="a" joint="arm"/><jointpos name="b" joint="arm"/>
    <jointvel name="v" joint="arm"/>
    <framepos name="tip" objtype="site" objname="tip"/></sensor>)";

TEST(StartPosition, OfEncodersThatDisagreeIsTheirMeanByTheirNoises) {
  const ModelPtr plant = SmallPlant(kLink);
  Channels channels;
  channels.sensors = {{"a", "a", 0, "rad", 1e-4}, {"b", "b", 0, "rad", 2e-4}};
  const VectorXd q =
      StartPosition(channels, *plant, Drawn(*plant), {{"a", 0.3}, {"b", 0.301}});
  EXPECT_NEAR(q[0], 0.8 * 0.3 + 0.2 * 0.301, 1e-12);
}

TEST(StartPosition, TakesMoreReadingsOfATipThanThereAreJoints) {
  const ModelPtr plant = SmallPlant(kLink);
  Channels channels;
  channels.sensors = {{"x", "tip", 0, "m"}, {"z", "tip", 2, "m"}};
  // A tip at 1 rad, each reading 10 um off.
  const VectorXd q = StartPosition(
      channels, *plant, Drawn(*plant),
      {{"x", -0.2 * std::sin(1.0) + 1e-5}, {"z", -0.2 * std::cos(1.0) + 1e-5}});
  EXPECT_NEAR(q[0], 1.0, 1e-4);
}

TEST(StartPosition, RaisesAHangingTipWhoseHeightNoJointChangesAtFirst) {
  const ModelPtr plant = SmallPlant(kLink);
  Channels channels;
  channels.sensors = {{"z", "tip", 2, "m"}};
  const VectorXd q = StartPosition(channels, *plant, Drawn(*plant), {{"z", -0.1}});
  EXPECT_NEAR(std::cos(q[0]), 0.5, 1e-9);
}

TEST(StartPosition, DoesNotTakeVelocitiesForPositions) {
  const ModelPtr plant = SmallPlant(kLink);
  Channels channels;
  channels.sensors = {{"a", "a", 0, "rad"}, {"v", "v", 0, "rad/s"}};
  const VectorXd q =
      StartPosition(channels, *plant, Drawn(*plant), {{"a", 0.3}, {"v", 7.0}});
  EXPECT_NEAR(q[0], 0.3, 1e-15);
}

TEST(StartPosition, NamesTheReadingThatTheMachineCannotComeNear) {
  const ModelPtr plant = SmallPlant(kLink);
  Channels channels;
  channels.sensors = {{"x", "tip", 0, "m"}};
  try {
    StartPosition(channels, *plant, Drawn(*plant), {{"x", 3.0}});
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("first reading of 'x', 3.0"),
              std::string::npos)
        << error.what();
  }
}

TEST(StartPosition, PutsJointsThatNoSensorReadsWhereEqualitiesHoldThem) {
  const ModelPtr plant = SmallPlant(R"(<worldbody>
    <body><joint name="motor1" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/></body>
    <body pos="0 1 0"><joint name="motor2" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/></body>
    <body pos="0 2 0"><joint name="pitch" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/></body>
    <body pos="0 3 0"><joint name="square" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/></body>
  </worldbody>
  <tendon><fixed name="c"><joint joint="pitch" coef="1"/>
    <joint joint="motor1" coef="-0.5"/><joint joint="motor2" coef="0.5"/></fixed></tendon>
  <equality><tendon tendon1="c"/>
    <joint joint1="square" joint2="motor1" polycoef="0 1 2 0 0"/></equality>
  <sensor><jointpos name="m1" joint="motor1"/><jointpos name="m2" joint="motor2"/>
  </sensor>)");
  Channels channels;
  channels.sensors = {{"m1", "m1", 0, "rad"}, {"m2", "m2", 0, "rad"}};
  const VectorXd q =
      StartPosition(channels, *plant, Drawn(*plant), {{"m1", 0.7}, {"m2", -0.2}});
  EXPECT_NEAR(q[0], 0.7, 1e-9);
  EXPECT_NEAR(q[1], -0.2, 1e-9);
  EXPECT_NEAR(q[2], 0.5 * 0.7 + 0.5 * 0.2, 1e-9);
  EXPECT_NEAR(q[3], 0.7 + 2.0 * 0.49, 1e-9);
}

TEST(StartPosition, ClosesALinkageOfWhichOneJointIsRead) {
  // A parallelogram: the follower turns as the crank does.
  const ModelPtr plant = SmallPlant(R"(<worldbody>
    <body name="crank"><joint name="crank" axis="0 1 0"/>
      <inertial pos="0 0 .1" mass="1" diaginertia=".01 .01 .01"/>
      <body name="coupler" pos="0 0 .2"><joint name="coupler" axis="0 1 0"/>
        <inertial pos=".2 0 0" mass="1" diaginertia=".01 .01 .01"/></body></body>
    <body name="follower" pos=".4 0 0"><joint name="follower" axis="0 1 0"/>
      <inertial pos="0 0 .1" mass="1" diaginertia=".01 .01 .01"/></body>
  </worldbody>
  <equality><connect body1="follower" body2="coupler" anchor="0 0 .2"/></equality>
  <sensor><jointpos name="q" joint="crank"/></sensor>)");
  Channels channels;
  channels.sensors = {{"q", "q", 0, "rad"}};
  const VectorXd q = StartPosition(channels, *plant, Drawn(*plant), {{"q", 0.6}});
  EXPECT_NEAR(q[0], 0.6, 1e-9);
  EXPECT_NEAR(q[1], -0.6, 1e-6);
  EXPECT_NEAR(q[2], 0.6, 1e-6);
}

TEST(StartPosition, TurnsAFreeBodyAsItsQuaternionReadsWhicheverItsSign) {
  const ModelPtr plant = SmallPlant(test::kQuadrotor);
  Channels channels;
  std::map<std::string, double> start;
  VectorXd quaternion(4);
  quaternion << 0.5, 0.5, -0.1, 0.7;
  quaternion.normalize();
  for (int i = 0; i < 4; ++i) {
    channels.sensors.push_back({"q" + std::to_string(i), "quat", i, "1"});
    start["q" + std::to_string(i)] = -quaternion[i];
  }
  channels.sensors.push_back({"z", "pos", 2, "m"});
  start["z"] = 1.7;
  const VectorXd q = StartPosition(channels, *plant, Drawn(*plant), start);
  EXPECT_NEAR(std::abs(q.tail(4).dot(quaternion)), 1.0, 1e-12);
  EXPECT_NEAR(q[2], 1.7, 1e-12);
  EXPECT_NEAR(q.head(2).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace mjdiag
