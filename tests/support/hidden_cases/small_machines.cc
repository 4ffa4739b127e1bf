#include "support/hidden_cases/small_machines.h"

#include <array>
#include <cmath>
#include <utility>

namespace mjdiag::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr const char* kDoublePendulum = R"(<mujoco model="double_pendulum">
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="Euler" tolerance="1e-12"/>
  <worldbody>
    <body name="upper" pos="0 0 1">
      <joint name="shoulder" type="hinge" axis="0 1 0" damping="0.012" armature="0.0015"/>
      <inertial pos="0 0 -0.17" mass="0.62" diaginertia="0.0052 0.0052 0.0002"/>
      <body name="lower" pos="0 0 -0.31">
        <joint name="elbow" type="hinge" axis="0 1 0" damping="0.006" armature="0.0015"/>
        <inertial pos="0 0 -0.15" mass="0.48" diaginertia="0.0036 0.0036 0.0001"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="shoulder_motor" joint="shoulder" gear="1"/>
    <motor name="elbow_motor" joint="elbow" gear="1"/>
  </actuator>
  <sensor>
    <jointpos name="shoulder_encoder" joint="shoulder"/>
    <jointpos name="elbow_encoder" joint="elbow"/>
  </sensor>
</mujoco>
)";

constexpr const char* kCartAndPole = R"(<mujoco model="cart_and_pole">
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="Euler" tolerance="1e-12"/>
  <worldbody>
    <body name="carriage" pos="0 0 0.8">
      <joint name="cart" type="slide" axis="1 0 0" damping="2.6"/>
      <inertial pos="0 0 0" mass="0.93" diaginertia="0.002 0.002 0.002"/>
      <body name="rod">
        <joint name="pole" type="hinge" axis="0 1 0" damping="0.0011"/>
        <inertial pos="0 0 -0.23" mass="0.17" diaginertia="0.0031 0.0031 0.00002"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="belt" joint="cart" gear="7.4"/></actuator>
  <sensor>
    <jointpos name="cart_encoder" joint="cart"/>
    <jointpos name="pole_encoder" joint="pole"/>
  </sensor>
</mujoco>
)";

constexpr const char* kLegOnABoom = R"(<mujoco model="leg_on_a_boom">
  <compiler angle="radian"/>
  <!-- 16 kHz: a step of 0.5 ms alone makes the touchdowns wrong by newton metres. -->
  <option timestep="0.0000625" integrator="Euler" tolerance="1e-12"/>
  <worldbody>
    <geom name="floor" type="plane" size="3 3 0.1"/>
    <body name="boom" pos="0 0 0.42">
      <joint name="yaw" type="hinge" axis="0 0 1" damping="0.03"/>
      <joint name="pitch" type="hinge" axis="0 -1 0" damping="0.02"/>
      <inertial pos="0.35 0 0" mass="0.8" diaginertia="0.001 0.11 0.11"/>
      <body name="thigh" pos="1.1 0 0">
        <joint name="hip" type="hinge" axis="1 0 0" damping="0.02" armature="0.006"/>
        <inertial pos="0 0 -0.06" mass="0.75" diaginertia="0.0021 0.0021 0.0005"/>
        <body name="shank" pos="0 0 -0.19">
          <joint name="knee" type="hinge" axis="1 0 0" damping="0.015" armature="0.006"/>
          <inertial pos="0 0 -0.08" mass="0.21" diaginertia="0.0008 0.0008 0.00005"/>
          <geom name="foot" type="sphere" size="0.022" pos="0 0 -0.19" mass="0"
                friction="0.9 0.005 0.0001"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="hip_motor" joint="hip" gear="1"/>
    <motor name="knee_motor" joint="knee" gear="1"/>
  </actuator>
  <sensor>
    <jointpos name="yaw_encoder" joint="yaw"/>
    <jointpos name="pitch_encoder" joint="pitch"/>
    <jointpos name="hip_encoder" joint="hip"/>
    <jointpos name="knee_encoder" joint="knee"/>
  </sensor>
</mujoco>
)";

struct Reading {
  const char* channel;
  const char* unit;
  const char* noise;
  const char* resolution;
};

std::string SetupOf(const std::string& name, const std::string& rates,
                    const std::vector<Reading>& sensors,
                    const std::vector<std::pair<std::string, std::string>>& motors) {
  std::string text = "schema = \"mjdiag.setup/1\"\nname = \"" + name +
                     "\"\nplant = \"plant.xml\"\n\n[rates]\n" + rates;
  for (const Reading& one : sensors) {
    text += std::string("\n[sensors.") + one.channel + "]\nelement = \"" + one.channel +
            "_encoder\"\nunit = \"" + one.unit + "\"\nnoise_sd = " + one.noise +
            "\nresolution = " + one.resolution + "\n";
  }
  for (const auto& [motor, unit] : motors) {
    text += "\n[actuators.u_" + motor + "]\nelement = \"" + motor + "\"\nunit = \"" +
            unit + "\"\n";
  }
  return text;
}

/// A sum of three tones that rises within half a second.
class Wander {
 public:
  Wander(CaseDice& dice, double amplitude, double slowest) {
    for (int i = 0; i < 3; ++i) {
      tones_.push_back({amplitude * dice.Even(0.5, 1.0) / (1.0 + i),
                        slowest * dice.Even(0.8, 1.2) * (1.0 + 1.7 * i),
                        dice.Even(0.0, kTurn)});
    }
  }
  double At(double t) const {
    double sum = 0.0;
    for (const auto& tone : tones_) {
      sum += tone[0] * (std::sin(kTurn * tone[1] * t + tone[2]));
    }
    return sum * (1.0 - std::exp(-t * t / 0.1));
  }

 private:
  std::vector<std::array<double, 3>> tones_;
};

OwnComputer::Law SwingBoth(CaseDice dice) {
  const Wander shoulder(dice, 1.1, 0.35);
  const Wander elbow(dice, 1.3, 0.5);
  return [=](double t, const VectorXd& y, const VectorXd& rate) -> VectorXd {
    return Eigen::Vector2d{9.0 * (shoulder.At(t) - y[0]) - 0.5 * rate[0],
                           4.0 * (elbow.At(t) - y[1]) - 0.15 * rate[1]};
  };
}

OwnComputer::Law MoveTheCart(CaseDice dice) {
  const Wander cart(dice, 0.16, 0.4);
  return [=](double t, const VectorXd& y, const VectorXd& rate) -> VectorXd {
    return VectorXd::Constant(1, 18.0 * (cart.At(t) - y[0]) - 1.1 * rate[0]);
  };
}

/// Swings in the air, squats and pushes off.
OwnComputer::Law Hop(CaseDice dice) {
  const Wander hip(dice, 0.3, 0.6);
  const Wander knee(dice, 0.35, 0.9);
  return [=](double t, const VectorXd& y, const VectorXd& rate) -> VectorXd {
    return Eigen::Vector2d{25.0 * (0.5 + hip.At(t) - y[2]) - 0.5 * rate[2],
                           20.0 * (-1.0 + knee.At(t) - y[3]) - 0.4 * rate[3]};
  };
}

Hidden RubbingElbow(const Machine& machine, CaseDice&) {
  constexpr double kForce = 0.06;  // N m
  Hidden hidden;
  hidden.physics.dry.push_back(
      [j = JointOf(machine, "elbow")](const Moment&, VectorXd& bound) {
        bound[j] += kForce;
      });
  hidden.truth = {{{"dry friction"},
                   {"elbow"},
                   {{"coulomb_friction", "elbow", {{"force", kForce}}}},
                   "coulomb_friction@elbow:force=0.06"}};
  return hidden;
}

Hidden WavyBelt(const Machine& machine, CaseDice&) {
  constexpr double kForce = 0.7, kPeriod = 0.094, kPhase = 1.9;  // N, m, rad
  Hidden hidden;
  hidden.physics.forces.push_back(
      [j = JointOf(machine, "cart")](const Moment& at, VectorXd& force) {
        force[j] += kForce * std::sin(kTurn * at.q[j] / kPeriod + kPhase);
      });
  hidden.truth = {{{"force along the stroke"},
                   {"cart"},
                   {{"force_ripple",
                     "cart",
                     {{"amplitude", kForce}, {"period", kPeriod}, {"phase", kPhase}}}},
                   "force_ripple@cart:amplitude=0.7,period=0.094,phase=1.9"}};
  return hidden;
}

Hidden WeakKnee(const Machine& machine, CaseDice&) {
  constexpr double kFactor = 0.92;
  Hidden hidden;
  hidden.physics.drives.push_back(
      [u = ActuatorOf(machine, "u_knee_motor")](const Moment&, VectorXd& drive) {
        drive[u] *= kFactor;
      });
  hidden.truth = {{{"drive gain"},
                   {"knee_motor", "knee"},
                   {{"motor_constant", "knee_motor", {{"factor", kFactor}}},
                    {"number", "gear@knee_motor", {{"factor", kFactor}}}},
                   "motor_constant@knee_motor:factor=0.92"}};
  return hidden;
}

}  // namespace

const std::vector<SmallMachine>& SmallMachines() {
  static const std::vector<SmallMachine> machines = {
      {"double_pendulum",
       kDoublePendulum,
       SetupOf("Double pendulum", "control = 500.0\nsubsteps = 2\n",
               {{"shoulder", "rad", "1e-4", "3.835e-4"},
                {"elbow", "rad", "1e-4", "3.835e-4"}},
               {{"shoulder_motor", "N m"}, {"elbow_motor", "N m"}}),
       8.0,
       {},
       SwingBoth,
       {{"double_pendulum_nothing", "nothing is hidden", Nothing},
        {"double_pendulum_rubs", "dry friction in the elbow", RubbingElbow}}},
      {"cart_and_pole",
       kCartAndPole,
       SetupOf("Cart and pole", "control = 500.0\nsubsteps = 2\n",
               {{"cart", "m", "1e-5", "2e-5"}, {"pole", "rad", "2e-4", "1.534e-3"}},
               {{"belt", "N"}}),
       10.0,
       {},
       MoveTheCart,
       {{"cart_and_pole_nothing", "nothing is hidden", Nothing},
        {"cart_and_pole_waves", "a belt that pulls by the place", WavyBelt}}},
      {"leg_on_a_boom",
       kLegOnABoom,
       SetupOf("Leg on a boom", "control = 1000.0\nsubsteps = 16\n",
               {{"yaw", "rad", "5e-5", "1.918e-4"},
                {"pitch", "rad", "5e-5", "1.918e-4"},
                {"hip", "rad", "5e-5", "1.918e-4"},
                {"knee", "rad", "5e-5", "1.918e-4"}},
               {{"hip_motor", "N m"}, {"knee_motor", "N m"}}),
       4.0,
       (VectorXd(4) << 0.0, -0.06, 0.5, -1.0).finished(),
       Hop,
       {{"leg_on_a_boom_nothing", "nothing is hidden", Nothing},
        {"leg_on_a_boom_weak", "the motor of the knee is 8 % weak", WeakKnee}}},
  };
  return machines;
}

}  // namespace mjdiag::test
