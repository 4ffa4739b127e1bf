// Linearisation under constraints, of any joints and actuators, and the maps of a step
// and a tick.

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/plugin/plant/transition.h"
#include "support/small_plant.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::SmallPlant;

Channels WithChannels(const std::vector<std::string>& actuators,
                      const std::vector<SensorSetup>& sensors) {
  Channels channels;
  channels.sensors = sensors;
  for (const std::string& name : actuators) {
    ActuatorSetup actuator;
    actuator.channel = actuator.element = name;
    channels.actuators.push_back(actuator);
  }
  return channels;
}

OperatingPoint AtRest(const mjModel& plant, const Channels& channels) {
  return HeldAt(plant, channels, FindRest(plant));
}

const std::vector<std::string> kRotors = {"t1", "t2", "t3", "t4"};

TEST(LinearizeAbout, TiedSlidesAreOneCoordinateWithTheMassOfBoth) {
  for (const double ratio : {1.0, -0.5}) {
    const ModelPtr plant = SmallPlant(test::Gantry(ratio));
    const Channels channels =
        WithChannels({"m1"}, {{"y1", "y1", 0, "m"}, {"y2", "y2", 0, "m"}});
    const Linearization linear =
        LinearizeAbout(*plant, channels, AtRest(*plant, channels));
    EXPECT_EQ(linear.model.coordinates, std::vector<std::string>{"y1"});
    EXPECT_EQ(linear.dependent, std::vector<std::string>{"y2"});
    EXPECT_NEAR(linear.ties(0, 0), ratio, 1e-6);
    EXPECT_NEAR(linear.model.M(0, 0), 4.0 + ratio * ratio * 4.0, 1e-5);
    EXPECT_NEAR(linear.model.D(0, 0), 60.0 + ratio * ratio * 60.0, 1e-4);
    EXPECT_NEAR(linear.model.K(0, 0), 0.0, 1e-6);
    EXPECT_NEAR(linear.model.Gamma(0, 0), 1.0, 1e-12);
    EXPECT_NEAR(linear.model.b(0, 0), 1.0, 1e-12);
    EXPECT_NEAR(linear.model.b(0, 1), ratio, 1e-6);
    EXPECT_TRUE(linear.stable);
  }
}

TEST(LinearizeAbout, AFootOnAFloorHoldsTheLegAndTheBodyMoves) {
  const ModelPtr plant = SmallPlant(test::kHopper);
  const Channels channels = WithChannels({"thrust"}, {{"height", "height", 0, "m"}});
  const Linearization linear =
      LinearizeAbout(*plant, channels, AtRest(*plant, channels));
  EXPECT_EQ(linear.model.coordinates, std::vector<std::string>{"leg"});
  EXPECT_NEAR(linear.model.M(0, 0), 4.0, 1e-9);
  EXPECT_NEAR(linear.model.K(0, 0), 4000.0, 1e-5);
  EXPECT_NEAR(linear.model.D(0, 0), 30.0, 1e-6);
  EXPECT_NEAR(linear.model.b(0, 0), -1.0, 1e-9);
}

TEST(LinearizeAbout, AMassThatALinkHoldsOnACircleIsAPendulum) {
  // K of the slides alone is 0: the weight pulls on the link, and the link turns.
  const ModelPtr plant = SmallPlant(R"(<worldbody>
    <body name="bob"><joint name="x" type="slide" axis="1 0 0"/>
      <joint name="z" type="slide" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="2" diaginertia=".1 .1 .1"/></body>
    <body name="link" pos="0 0 0.5"><joint name="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="1e-4" diaginertia="1e-6 1e-6 1e-6"/></body>
  </worldbody>
  <equality><connect body1="bob" body2="link" anchor="0 0 0" solref="0.004 1"/></equality>
  <actuator><motor name="m" joint="x"/></actuator>)");
  const Channels channels = WithChannels({"m"}, {});
  const Linearization linear =
      LinearizeAbout(*plant, channels, AtRest(*plant, channels));
  ASSERT_EQ(linear.model.coordinates, std::vector<std::string>{"x"});
  EXPECT_NEAR(linear.model.M(0, 0), 2.0, 1e-3);
  EXPECT_NEAR(linear.model.K(0, 0) / (2.0 * 9.81 / 0.5), 1.0, 1e-3);
}

TEST(LinearizeAbout, AQuadrotorIsHeldByItsRotorsAndTiltsIntoMotion) {
  const ModelPtr plant = SmallPlant(test::kQuadrotor);
  const Channels channels = WithChannels(kRotors, {{"z", "pos", 2, "m"}});
  const OperatingPoint point = AtRest(*plant, channels);
  EXPECT_FALSE(point.rests);
  EXPECT_LT(point.applied_force.norm(), 1e-9);
  for (const double thrust : point.controls)
    EXPECT_NEAR(thrust, 1.3 * 9.81 / 4.0, 1e-9);
  const Linearization linear = LinearizeAbout(*plant, channels, point);
  EXPECT_EQ(linear.model.coordinates,
            (std::vector<std::string>{"base.x", "base.y", "base.z", "base.rx",
                                      "base.ry", "base.rz"}));
  // Thrust turns with the body: m x'' = m g ry, m y'' = -m g rx.
  EXPECT_NEAR(linear.model.K(0, 4), -1.3 * 9.81, 1e-8);
  EXPECT_NEAR(linear.model.K(1, 3), 1.3 * 9.81, 1e-8);
  EXPECT_NEAR(linear.model.b(2, 0), 1.0, 1e-12);
}

TEST(LinearizeAbout, AnActuatorWithDynamicsHasItsActivationAsInput) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body><joint name="elbow" axis="0 1 0"
      damping="0.4" stiffness="3"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.04 0.04 0.04"/></body></worldbody>
    <actuator><general name="valve" joint="elbow" dyntype="filter" dynprm="0.05"
      gainprm="6"/></actuator>)");
  const Channels channels = WithChannels({"valve"}, {});
  const OperatingPoint point = AtRest(*plant, channels);
  const Linearization linear = LinearizeAbout(*plant, channels, point);
  EXPECT_NEAR(linear.model.Gamma(0, 0), 6.0, 1e-12);
  ASSERT_EQ(linear.notes.size(), 1u);
  EXPECT_NE(linear.notes[0].find("'valve' has dynamics of its own"), std::string::npos);
  const Transition transition = TransitionAbout(*plant, channels, point, 3);
  EXPECT_EQ(StateNames(*plant),
            (std::vector<std::string>{"elbow", "elbow'", "valve.act"}));
  EXPECT_NEAR(transition.step.A(2, 2), 1.0 - 0.001 / 0.05, 1e-9);
  EXPECT_NEAR(transition.step.B(2, 0), 0.001 / 0.05, 1e-9);
}

TEST(LinearizeAbout, APoseThatFallsOverIsHeldAndSaidToBeUnstable) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0.2" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body></worldbody><actuator><motor name="m" joint="hinge" gear="2"/></actuator>)");
  const Channels channels = WithChannels({"m"}, {});
  const VectorXd tilted = VectorXd::Constant(1, 0.3);
  const OperatingPoint point = HeldAt(*plant, channels, PoseAt(*plant, tilted));
  EXPECT_NEAR(2.0 * point.controls[0], -9.81 * 0.2 * std::sin(0.3), 1e-9);
  const Linearization linear = LinearizeAbout(*plant, channels, point);
  EXPECT_FALSE(linear.stable);
  EXPECT_NEAR(linear.model.K(0, 0), -9.81 * 0.2 * std::cos(0.3), 1e-9);
}

TEST(LinearizeAbout, WhatLimitedActuatorsCannotHoldIsHeldByForces) {
  const ModelPtr plant = SmallPlant(R"(<worldbody><body>
      <joint name="hinge" axis="0 1 0"/>
      <inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body></worldbody>
    <actuator><motor name="m" joint="hinge" ctrlrange="-1 1"/></actuator>)");
  const Channels channels = WithChannels({"m"}, {});
  const OperatingPoint point =
      HeldAt(*plant, channels, PoseAt(*plant, VectorXd::Zero(1)));
  EXPECT_EQ(point.controls[0], 0.0);
  EXPECT_NEAR(point.applied_force[0], -9.81 * 0.2, 1e-12);
  EXPECT_NEAR(point.holding_force[0], -9.81 * 0.2, 1e-12);
}

/// MuJoCo's own steps from a state that is `by` away from a point, controls more by that.
/// What its sensors read first goes to `readings`.
DataPtr After(const mjModel& plant, const OperatingPoint& point, const VectorXd& by,
              const VectorXd& controls, int steps, VectorXd& readings) {
  const ModelPtr exact = CopyModel(plant);
  exact->opt.tolerance = 1e-16;
  DataPtr data = MakeData(*exact);
  const Index nv = plant.nv;
  Set(plant, point, *data);
  VectorXd::Map(data->qpos, plant.nq) = Displaced(plant, point.qpos, by.head(nv));
  VectorXd::Map(data->qvel, nv) += by.segment(nv, nv);
  VectorXd::Map(data->act, plant.na) += by.tail(plant.na);
  VectorXd::Map(data->ctrl, plant.nu) += controls;
  for (int i = 0; i < steps; ++i) {
    mj_step(exact.get(), data.get());
    if (i == 0) readings = VectorXd::Map(data->sensordata, plant.nsensordata);
  }
  return data;
}

/// d [x+; y] by central differences of MuJoCo's own steps.
MatrixXd Derivative(const mjModel& plant, const OperatingPoint& point, int steps,
                    bool by_control) {
  constexpr double kStep = 2e-6;
  const Index nv = plant.nv;
  const Index states = 2 * nv + plant.na;
  const Index arguments = by_control ? plant.nu : states;
  MatrixXd derivative(states + plant.nsensordata, arguments);
  for (Index j = 0; j < arguments; ++j) {
    VectorXd state = VectorXd::Zero(states);
    VectorXd controls = VectorXd::Zero(plant.nu);
    (by_control ? controls : state)[j] = kStep;
    VectorXd read_more;
    VectorXd read_less;
    const DataPtr more = After(plant, point, state, controls, steps, read_more);
    const DataPtr less = After(plant, point, -state, -controls, steps, read_less);
    const auto change = [&](mjtNum* mjData::*array, int size) -> VectorXd {
      return VectorXd::Map((*more).*array, size) - VectorXd::Map((*less).*array, size);
    };
    derivative.col(j) << Displacement(plant, VectorXd::Map(less->qpos, plant.nq),
                                      VectorXd::Map(more->qpos, plant.nq)),
        change(&mjData::qvel, static_cast<int>(nv)),
        change(&mjData::act, static_cast<int>(plant.na)), read_more - read_less;
  }
  return derivative / (2.0 * kStep);
}

void ExpectTheTickOfMujoco(const mjModel& plant, const Channels& channels,
                           const OperatingPoint& point) {
  constexpr int kSubsteps = 3;
  ASSERT_EQ(std::ssize(channels.actuators), plant.nu);
  const Transition transition = TransitionAbout(plant, channels, point, kSubsteps);
  const std::vector<int> sensors = SensorAddresses(channels, plant);
  for (const auto& [steps, map] :
       {std::pair{1, &transition.step}, std::pair{kSubsteps, &transition.tick}}) {
    const Index states = map->A.rows();
    const MatrixXd by_state = Derivative(plant, point, steps, false);
    const MatrixXd by_control = Derivative(plant, point, steps, true);
    const MatrixXd A = by_state.topRows(states);
    const MatrixXd B = by_control.topRows(states);
    const MatrixXd C = by_state.bottomRows(plant.nsensordata)(sensors, Eigen::all);
    const MatrixXd D = by_control.bottomRows(plant.nsensordata)(sensors, Eigen::all);
    EXPECT_LT((map->A - A).norm(), 1e-6 * A.norm()) << steps;
    EXPECT_LT((map->B - B).norm(), 1e-6 * std::max(1e-2, B.norm())) << steps;
    EXPECT_LT((map->C - C).norm(), 1e-6 * std::max(1.0, C.norm())) << steps;
    EXPECT_LT((map->D - D).norm(), 1e-6 * std::max(1.0, D.norm())) << steps;
  }
}

TEST(Transition, IsThatOfMujocosStepsUnderAnEquality) {
  const ModelPtr plant = SmallPlant(test::Gantry(0.7));
  const Channels channels = WithChannels({"m1"}, {});
  ExpectTheTickOfMujoco(*plant, channels, AtRest(*plant, channels));
}

TEST(Transition, IsThatOfMujocosStepsOnAFloor) {
  const ModelPtr plant = SmallPlant(test::kHopper);
  const Channels channels = WithChannels({"thrust"}, {{"h", "height", 0, "m"}});
  ExpectTheTickOfMujoco(*plant, channels, AtRest(*plant, channels));
}

TEST(Transition, IsThatOfMujocosStepsOfAFreeBodyInMotion) {
  const ModelPtr plant = SmallPlant(test::kQuadrotor);
  const Channels channels = WithChannels(kRotors, {{"x", "pos", 0, "m"},
                                                   {"wx", "gyro", 0, "rad/s"},
                                                   {"q2", "quat", 2, "1"},
                                                   {"ay", "acc", 1, "m/s^2"},
                                                   {"az", "acc", 2, "m/s^2"}});
  VectorXd velocity(6);
  velocity << 0.1, -0.2, 0.3, 0.4, -0.7, 1.1;
  const OperatingPoint point =
      MovingAt(*plant, channels, VectorXd::Map(plant->qpos0, plant->nq), velocity,
               VectorXd::Zero(6), VectorXd::Constant(4, 3.0));
  ExpectTheTickOfMujoco(*plant, channels, point);
}

TEST(Transition, HasTheFeedthroughOfAnAccelerometer) {
  const ModelPtr plant = SmallPlant(test::kQuadrotor);
  const Channels channels =
      WithChannels(kRotors, {{"az", "acc", 2, "m/s^2"}, {"wx", "gyro", 0, "rad/s"}});
  const Transition transition =
      TransitionAbout(*plant, channels, AtRest(*plant, channels), 2);
  EXPECT_NEAR(transition.step.D(0, 0), 1.0 / 1.3, 1e-6);
  EXPECT_NEAR(transition.step.C(1, 6 + 3), 1.0, 1e-6);
  EXPECT_NEAR(transition.step.D(1, 0), 0.0, 1e-9);
}

}  // namespace
}  // namespace mjdiag
