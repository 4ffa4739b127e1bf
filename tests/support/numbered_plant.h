#pragma once
// A plant that has a number of every kind, written down once for all tests of them.

#include <map>
#include <string>

#include "support/any_machine.h"
#include "support/small_plant.h"

namespace mjdiag::test {

/// Values of the MJCF by the names of the numbers.
using MjcfValues = std::map<std::string, std::string>;

inline const MjcfValues kNumberedValues = {{"mass@fore", "1.5"},
                                           {"inertia@fore", "0.02 0.021 0.004"},
                                           {"stiffness@shoulder", "7.5"},
                                           {"damping@shoulder", "0.4"},
                                           {"friction@shoulder", "0.25"},
                                           {"armature@shoulder", "0.03"},
                                           {"gear@push", "2.5"},
                                           {"gain@volts", "0.7"},
                                           {"kp@servo", "30"},
                                           {"kv@drive", "1.2"},
                                           {"tendon_stiffness@cable", "50"},
                                           {"tendon_damping@cable", "0.6"},
                                           {"tendon_friction@rope", "0.3"},
                                           {"centre_z@fore", "-0.15"},
                                           {"ref@shoulder", "0.3"},
                                           {"ref@slide", "0.02"}};

/// What is inside <mujoco>. A drive that feeds back position and velocity has both gains
/// in kv@drive's line; the back EMF of a voltage is as large as its gain.
/// @param more  in front of it
inline std::string NumberedMjcf(const MjcfValues& value = kNumberedValues,
                                const std::string& more = "") {
  const auto of = [&](const char* name) { return value.at(name); };
  return more + R"(<worldbody>
    <site name="anchor" pos="0.3 0 0.4"/>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" springref="0.1" ref=")" +
         of("ref@shoulder") + R"(" stiffness=")" + of("stiffness@shoulder") +
         R"(" damping=")" + of("damping@shoulder") + R"(" frictionloss=")" +
         of("friction@shoulder") + R"(" armature=")" + of("armature@shoulder") + R"("/>
      <inertial pos="0 0 -0.2" mass="2" diaginertia="0.03 0.03 0.002"/>
      <site name="hand" pos="0.02 0 -0.3"/>
      <body name="fore" pos="0 0 -0.4">
        <joint name="slide" type="slide" axis="0 0 1" stiffness="400" damping="5" ref=")" +
         of("ref@slide") + R"("/>
        <joint name="elbow" axis="0 1 0" damping="0.3"/>
        <inertial pos="0 0 )" +
         of("centre_z@fore") + R"(" mass=")" + of("mass@fore") + R"(" diaginertia=")" +
         of("inertia@fore") + R"("/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="cable" stiffness=")" +
         of("tendon_stiffness@cable") + R"(" damping=")" + of("tendon_damping@cable") +
         R"("><site site="anchor"/><site site="hand"/></spatial>
    <fixed name="rope" frictionloss=")" +
         of("tendon_friction@rope") + R"("><joint joint="shoulder" coef="1"/>
      <joint joint="elbow" coef="-0.5"/></fixed>
  </tendon>
  <actuator>
    <motor name="push" joint="slide" gear=")" +
         of("gear@push") + R"("/>
    <general name="volts" joint="shoulder" gainprm=")" +
         of("gain@volts") + R"(" biastype="affine" biasprm="0 0 -)" + of("gain@volts") +
         R"("/>
    <position name="servo" joint="elbow" kp=")" +
         of("kp@servo") + R"("/>
    <general name="drive" joint="shoulder" gainprm="20" biastype="affine" biasprm="0 -20 -)" +
         of("kv@drive") + R"("/>
  </actuator>
  <sensor><jointpos name="q1" joint="shoulder"/><jointpos name="q2" joint="slide"/>
    <jointpos name="q3" joint="elbow"/></sensor>)";
}

inline Machine NumberedMachine(const MjcfValues& value = kNumberedValues,
                               const std::string& more = "") {
  return MachineOf(
      "<mujoco><compiler angle=\"radian\"/><option timestep=\"0.001\" "
      "tolerance=\"1e-12\"/>" +
          NumberedMjcf(value, more) + "</mujoco>",
      R"([rates]
control = 500.0
substeps = 2
[sensors.q1]
element = "q1"
unit = "rad"
noise_sd = 1e-5
[sensors.q2]
element = "q2"
unit = "m"
noise_sd = 1e-5
[sensors.q3]
element = "q3"
unit = "rad"
noise_sd = 1e-5
[actuators.push]
element = "push"
unit = "N"
[actuators.volts]
element = "volts"
unit = "V"
[actuators.servo]
element = "servo"
unit = "rad"
[actuators.drive]
element = "drive"
unit = "rad"
)");
}

}  // namespace mjdiag::test
