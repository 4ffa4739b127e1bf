#pragma once
// An arm of two links that hangs at rest and is raised above its shoulder, and
// measurements of it under a controller that the setup of the arm does not have. The
// machine that is measured takes finer steps than its model.

#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/changes.h"
#include "support/temporary_folder.h"

namespace mjdiag::test {

struct Arm {
  static constexpr double kNoise = 1e-5;  // rad

  Machine machine = Load(2, "");

  const Setup& setup() const { return machine.setup(); }

  /// Three seconds under the controller, with these effects; 2 substeps: those of the
  /// model.
  static Record Measure(const std::vector<std::string>& effects = {},
                        double noise_scale = 1.0, int substeps = 8,
                        std::uint64_t seed = 1) {
    const Machine held = Load(substeps, kController);
    RunOptions options;
    options.noise_scale = noise_scale;
    options.seed = seed;
    return Simulate(
        held.With(With(effects)),
        FollowTrajectory(held.setup(), held.setup().trajectories.Find("default")),
        options);
  }

 private:
  static Machine Load(int substeps, const std::string& more) {
    const TemporaryFolder folder;
    folder.Write("plant.xml", kPlant);
    folder.Write("setup.toml", kSetup + more);
    const Setup setup = ReadSetup(folder.path().string(),
                                  {"rates.substeps=" + std::to_string(substeps)});
    const ModelPtr plant = LoadModel(setup.plant);
    plant->opt.timestep = setup.rates.step();
    PreparePlant(setup.physics, *plant);
    return {setup, *plant};
  }

  static constexpr const char* kPlant = R"(<mujoco model="arm">
  <compiler angle="radian"/>
  <option timestep="0.0005" integrator="Euler" gravity="0 0 -9.81" tolerance="1e-12"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" type="hinge" axis="0 -1 0" armature="0.01"/>
      <inertial pos="0 0 -0.2" mass="2" diaginertia="0.02 0.02 0.002"/>
      <body name="fore" pos="0 0 -0.4">
        <joint name="elbow" type="hinge" axis="0 -1 0" armature="0.005"/>
        <inertial pos="0 0 -0.15" mass="1" diaginertia="0.008 0.008 0.001"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="motor1" joint="shoulder" gear="1"/>
    <motor name="motor2" joint="elbow" gear="1"/>
  </actuator>
  <sensor>
    <jointpos name="encoder1" joint="shoulder"/>
    <jointpos name="encoder2" joint="elbow"/>
  </sensor>
</mujoco>
)";
  static inline const std::string kSetup = R"(schema = "mjdiag.setup/1"
name = "arm"
plant = "plant.xml"
[rates]
control = 1000.0
substeps = 2
[sensors.q1]
element = "encoder1"
unit = "rad"
noise_sd = 1e-5
[sensors.q2]
element = "encoder2"
unit = "rad"
noise_sd = 1e-5
[actuators.tau1]
element = "motor1"
unit = "N m"
[actuators.tau2]
element = "motor2"
unit = "N m"
)";
  static inline const std::string kController = R"(
[axes.q1]
sensor = "q1"
actuator = "tau1"
feedback = { numerator = [12400.0, -12000.0], denominator = [1.0, 0.0] }
limits = { velocity = 4.0, acceleration = 30.0, jerk = 1000.0, snap = 50000.0 }
[axes.q2]
sensor = "q2"
actuator = "tau2"
feedback = { numerator = [2100.0, -2000.0], denominator = [1.0, 0.0] }
limits = { velocity = 6.0, acceleration = 60.0, jerk = 2000.0, snap = 100000.0 }
[trajectories.default]
duration = 3.0
moves = [
  { at = 0.1, by = { q1 = 2.6, q2 = -1.2 } },
  { at = 1.2, by = { q1 = -1.1, q2 = 2.4 } },
  { at = 2.1, by = { q1 = 0.9, q2 = -1.5 } },
]
)";
};

}  // namespace mjdiag::test
