// Machines that fall without a controller that nobody wrote down: a double pendulum, a cart
// with a pole, a leg on a boom. Each has one cause hidden in it.

#include <gtest/gtest.h>

#include <algorithm>

#include "mjdiag/discovery/discovery.h"
#include "support/held_machine.h"

namespace mjdiag {
namespace {

const FoundCause* Find(const Discovery& discovery, const std::string& effect,
                       const std::string& site) {
  const auto found = std::ranges::find_if(discovery.causes, [&](const FoundCause& one) {
    return one.cause.name() == effect && one.cause.site == site;
  });
  return found == discovery.causes.end() ? nullptr : &*found;
}

Discovery DiscoverIn(const test::HeldMachine& machine,
                     const std::vector<std::string>& hidden) {
  DiscoverOptions options;
  options.figures = false;
  options.budget = 60.0;
  return Discover(machine.Model(), machine.Measure(hidden), nullptr, options);
}

std::string SensorOf(const std::string& channel, const std::string& element,
                     const std::string& unit) {
  return "[sensors." + channel + "]\nelement = \"" + element + "\"\nunit = \"" + unit +
         "\"\nnoise_sd = 1e-5\n";
}

std::string ActuatorOf(const std::string& channel, const std::string& element,
                       const std::string& unit) {
  return "[actuators." + channel + "]\nelement = \"" + element + "\"\nunit = \"" +
         unit + "\"\n";
}

/// PD of a tick of a millisecond.
std::string AxisOf(const std::string& sensor, const std::string& actuator, double kp,
                   double kd, const std::string& limits) {
  const double d = kd / 1e-3;
  return "[axes." + sensor + "]\nsensor = \"" + sensor + "\"\nactuator = \"" +
         actuator + "\"\nfeedback = { numerator = [" + std::to_string(kp + d) + ", " +
         std::to_string(-d) + "], denominator = [1.0, 0.0] }\nlimits = { " + limits +
         " }\n";
}

constexpr const char* kFastTurns =
    "velocity = 5.0, acceleration = 40.0, jerk = 1500.0, snap = 80000.0";
constexpr const char* kSlides =
    "velocity = 1.5, acceleration = 8.0, jerk = 300.0, snap = 20000.0";

test::HeldMachine DoublePendulum() {
  return {R"(<mujoco model="double pendulum">
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="Euler" gravity="0 0 -9.81" tolerance="1e-12"/>
  <worldbody>
    <body name="first">
      <joint name="pivot" type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 -0.25" mass="1.5" diaginertia="0.03 0.03 0.001"/>
      <body name="second" pos="0 0 -0.5">
        <joint name="knee" type="hinge" axis="0 1 0"/>
        <inertial pos="0 0 -0.2" mass="0.8" diaginertia="0.012 0.012 0.0005"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="drive1" joint="pivot" gear="1"/>
    <motor name="drive2" joint="knee" gear="1"/>
  </actuator>
  <sensor>
    <jointpos name="encoder1" joint="pivot"/>
    <jointpos name="encoder2" joint="knee"/>
  </sensor>
</mujoco>)",
          "[rates]\ncontrol = 1000.0\n" + SensorOf("a", "encoder1", "rad") +
              SensorOf("b", "encoder2", "rad") + ActuatorOf("ta", "drive1", "N m") +
              ActuatorOf("tb", "drive2", "N m"),
          AxisOf("a", "ta", 400.0, 14.0, kFastTurns) +
              AxisOf("b", "tb", 90.0, 2.5, kFastTurns) +
              "[trajectories.default]\nduration = 4.0\nmoves = [\n"
              "  { at = 0.1, by = { a = 2.4, b = -1.5 } },\n"
              "  { at = 1.3, by = { a = -1.6, b = 2.6 } },\n"
              "  { at = 2.4, by = { a = 1.1, b = -1.9 } },\n"
              "  { at = 3.2, by = { a = -0.7, b = 0.8 } },\n]\n"};
}

test::HeldMachine CartWithPole() {
  return {R"(<mujoco model="cart with a pole">
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="Euler" gravity="0 0 -9.81" tolerance="1e-12"/>
  <worldbody>
    <body name="cart">
      <joint name="rail" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
      <body name="pole">
        <joint name="hinge" type="hinge" axis="0 1 0"/>
        <inertial pos="0 0 0.3" mass="0.6" diaginertia="0.02 0.02 0.0005"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="belt" joint="rail" gear="1"/>
    <motor name="reaction" joint="hinge" gear="1"/>
  </actuator>
  <sensor>
    <jointpos name="scale" joint="rail"/>
    <jointpos name="encoder" joint="hinge"/>
  </sensor>
</mujoco>)",
          "[rates]\ncontrol = 1000.0\n" + SensorOf("x", "scale", "m") +
              SensorOf("tilt", "encoder", "rad") + ActuatorOf("f", "belt", "N") +
              ActuatorOf("t", "reaction", "N m"),
          AxisOf("x", "f", 2000.0, 80.0, kSlides) +
              AxisOf("tilt", "t", 40.0, 1.5, kFastTurns) +
              "[trajectories.default]\nduration = 4.0\nmoves = [\n"
              "  { at = 0.1, by = { x = 0.4, tilt = 0.9 } },\n"
              "  { at = 1.2, by = { x = -0.7, tilt = -1.9 } },\n"
              "  { at = 2.3, by = { x = 0.5, tilt = 1.7 } },\n"
              "  { at = 3.2, by = { x = -0.3, tilt = -0.6 } },\n]\n"};
}

test::HeldMachine LegOnABoom() {
  return {R"(<mujoco model="leg on a boom">
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="Euler" gravity="0 0 -9.81" tolerance="1e-12"/>
  <worldbody>
    <body name="boom" pos="0 0 1">
      <joint name="pitch" type="hinge" axis="0 1 0"/>
      <inertial pos="0.5 0 0" mass="1.2" diaginertia="0.002 0.1 0.1"/>
      <body name="thigh" pos="1.1 0 0">
        <joint name="hip" type="hinge" axis="0 1 0"/>
        <inertial pos="0 0 -0.1" mass="0.9" diaginertia="0.006 0.006 0.001"/>
        <body name="shank" pos="0 0 -0.22">
          <joint name="knee" type="hinge" axis="0 1 0"/>
          <inertial pos="0 0 -0.12" mass="0.35" diaginertia="0.003 0.003 0.0002"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="lift" joint="pitch" gear="1"/>
    <motor name="hip_drive" joint="hip" gear="1"/>
    <motor name="knee_drive" joint="knee" gear="1"/>
  </actuator>
  <sensor>
    <jointpos name="encoder1" joint="pitch"/>
    <jointpos name="encoder2" joint="hip"/>
    <jointpos name="encoder3" joint="knee"/>
  </sensor>
</mujoco>)",
          "[rates]\ncontrol = 1000.0\n" + SensorOf("p", "encoder1", "rad") +
              SensorOf("h", "encoder2", "rad") + SensorOf("k", "encoder3", "rad") +
              ActuatorOf("tp", "lift", "N m") + ActuatorOf("th", "hip_drive", "N m") +
              ActuatorOf("tk", "knee_drive", "N m"),
          AxisOf("p", "tp", 3000.0, 90.0, kFastTurns) +
              AxisOf("h", "th", 120.0, 3.0, kFastTurns) +
              AxisOf("k", "tk", 60.0, 1.0, kFastTurns) +
              "[trajectories.default]\nduration = 4.0\nmoves = [\n"
              "  { at = 0.1, by = { p = -0.5, h = 0.9, k = -1.6 } },\n"
              "  { at = 1.2, by = { p = 0.8, h = -1.7, k = 2.2 } },\n"
              "  { at = 2.3, by = { p = -0.6, h = 1.5, k = -1.3 } },\n"
              "  { at = 3.2, by = { p = 0.4, h = -0.8, k = 0.9 } },\n]\n"};
}

/// Named alone, with its value within the interval and that within a tenth of it.
void ExpectFoundAlone(const Discovery& discovery, const std::string& effect,
                      const std::string& site, double value) {
  EXPECT_EQ(discovery.causes.size(), 1U);
  const FoundCause* found = Find(discovery, effect, site);
  ASSERT_NE(found, nullptr);
  const CauseParameter& size = found->parameters.front();
  EXPECT_LT(size.low, value);
  EXPECT_GT(size.high, value);
  EXPECT_LT(size.high - size.low, 0.2 * value);
}

TEST(FallingMachines, DryFrictionInTheKneeOfADoublePendulumIsNamed) {
  ExpectFoundAlone(DiscoverIn(DoublePendulum(), {"coulomb_friction@knee:force=0.15"}),
                   "coulomb_friction", "knee", 0.15);
}

TEST(FallingMachines, AResistanceOnTheRailOfACartWithAPoleIsNamed) {
  ExpectFoundAlone(DiscoverIn(CartWithPole(), {"viscous_friction@rail:coefficient=6"}),
                   "viscous_friction", "rail", 6.0);
}

TEST(FallingMachines, ASpringInTheHipOfALegOnABoomIsNamed) {
  ExpectFoundAlone(DiscoverIn(LegOnABoom(), {"linear_stiffness@hip:stiffness=3"}),
                   "linear_stiffness", "hip", 3.0);
}

}  // namespace
}  // namespace mjdiag
