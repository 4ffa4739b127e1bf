#pragma once
// A machine of an MJCF and a setup that a test writes down.

#include <string>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "support/temporary_folder.h"

namespace mjdiag::test {

/// @param setup  what comes behind the plant: [rates], [sensors], [actuators], ...
inline Machine MachineOf(const std::string& plant, const std::string& setup) {
  const TemporaryFolder folder;
  folder.Write("plant.xml", plant);
  folder.Write(
      "setup.toml",
      "schema = \"mjdiag.setup/1\"\nname = \"Any\"\nplant = \"plant.xml\"\n" + setup);
  return Machine(ReadSetup(folder.path().string()));
}

/// Models of every kind that MuJoCo steps, each of one body or a few, with one actuator
/// "u" and one position that is read, "y".
struct AnyKind {
  const char* name;
  const char* model;
};

inline Machine MachineOf(const AnyKind& kind) {
  return MachineOf(std::string("<mujoco model=\"") + kind.name +
                       "\"><compiler angle=\"radian\" autolimits=\"true\"/>" +
                       kind.model + "</mujoco>",
                   "[rates]\ncontrol = 1000.0\n"
                   "[sensors.y]\nelement = \"y\"\nunit = \"m\"\n"
                   "[actuators.u]\nelement = \"u\"\nunit = \"N\"\n");
}

/// One whose velocities mjd_transitionFD differentiates otherwise than mj_step steps.
inline constexpr AnyKind kRungeKutta = {
    "Runge-Kutta",
    R"(<option timestep="0.001" integrator="RK4"/><worldbody><body>
       <joint name="j" axis="0 1 0" damping="0.3"/>
       <inertial pos="0.1 0 -0.3" mass="1" diaginertia="0.02 0.02 0.01"/></body></worldbody>
       <actuator><motor name="u" joint="j"/></actuator>
       <sensor><jointpos name="y" joint="j"/></sensor>)"};

inline constexpr AnyKind kEveryKind[] = {
    {"hinge", R"(<option timestep="0.001"/><worldbody><body>
       <joint name="j" axis="0 1 0" damping="0.1" stiffness="2"/>
       <inertial pos="0.1 0 -0.3" mass="1" diaginertia="0.02 0.02 0.01"/></body></worldbody>
       <actuator><motor name="u" joint="j"/></actuator>
       <sensor><jointpos name="y" joint="j"/></sensor>)"},
    {"ball", R"(<option timestep="0.001"/><worldbody><body>
       <joint name="j" type="ball" damping="0.1"/>
       <inertial pos="0.1 0 -0.3" mass="1" diaginertia="0.02 0.03 0.01"/>
       <site name="s" pos="0.2 0 0"/></body></worldbody>
       <actuator><motor name="u" joint="j" gear="0.3 1 0.2 0 0 0"/></actuator>
       <sensor><framepos name="y" objtype="site" objname="s"/></sensor>)"},
    {"free", R"(<option timestep="0.001" density="1.2"/><worldbody><body pos="0 0 1">
       <freejoint name="j"/>
       <inertial pos="0 0.1 0" mass="1" diaginertia="0.02 0.03 0.01"/>
       <site name="s" pos="0.2 0 0"/></body></worldbody>
       <actuator><motor name="u" site="s" gear="0 0 1 0 0 0.1"/></actuator>
       <sensor><framepos name="y" objtype="site" objname="s"/></sensor>)"},
    {"equality", R"(<option timestep="0.001"/><worldbody>
       <body><joint name="j" type="slide" axis="1 0 0"/>
       <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
       <body><joint name="k" type="slide" axis="1 0 0" damping="2"/>
       <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></worldbody>
       <equality><joint joint1="j" joint2="k" polycoef="0 0.5 0.3 0 0"/></equality>
       <actuator><motor name="u" joint="j"/></actuator>
       <sensor><jointpos name="y" joint="k"/></sensor>)"},
    {"tendon", R"(<option timestep="0.001"/><worldbody><site name="a" pos="0 0 0"/>
       <body pos="0.3 0 0"><joint name="j" type="slide" axis="1 0 0"/>
       <joint name="k" type="slide" axis="0 0 1"/>
       <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="b"/></body></worldbody>
       <tendon><spatial name="t" stiffness="80" damping="1" springlength="0.2"><site site="a"/>
       <site site="b"/></spatial></tendon>
       <actuator><motor name="u" tendon="t"/></actuator>
       <sensor><tendonpos name="y" tendon="t"/></sensor>)"},
    {"contact", R"(<option timestep="0.001" cone="elliptic"/><worldbody>
       <geom type="plane" size="1 1 1"/>
       <body pos="0 0 0.1"><freejoint name="j"/><geom type="sphere" size="0.1" mass="1"/>
       <site name="s"/></body></worldbody>
       <actuator><motor name="u" site="s" gear="1 0 -5 0 0.1 0"/></actuator>
       <sensor><framepos name="y" objtype="site" objname="s"/></sensor>)"},
    {"position servo", R"(<option timestep="0.001"/><worldbody><body>
       <joint name="j" axis="0 1 0" damping="0.1" armature="0.01"/>
       <inertial pos="0.1 0 -0.3" mass="1" diaginertia="0.02 0.02 0.01"/></body></worldbody>
       <actuator><position name="u" joint="j" kp="20"/></actuator>
       <sensor><jointpos name="y" joint="j"/></sensor>)"},
    {"filter", R"(<option timestep="0.001"/><worldbody><body>
       <joint name="j" axis="0 1 0" damping="0.1"/>
       <inertial pos="0.1 0 -0.3" mass="1" diaginertia="0.02 0.02 0.01"/></body></worldbody>
       <actuator><general name="u" joint="j" dyntype="filter" dynprm="0.05" gainprm="3"/>
       </actuator><sensor><jointpos name="y" joint="j"/></sensor>)"},
    {"muscle", R"(<option timestep="0.001"/><worldbody><body>
       <joint name="j" axis="0 1 0" damping="0.1" range="-1 1"/>
       <inertial pos="0.1 0 -0.3" mass="1" diaginertia="0.02 0.02 0.01"/></body></worldbody>
       <actuator><muscle name="u" joint="j" force="5"/></actuator>
       <sensor><jointpos name="y" joint="j"/></sensor>)"},
    {"implicit", R"(<option timestep="0.001" integrator="implicit"/><worldbody><body>
       <joint name="j" axis="0 1 0" damping="0.3"/>
       <inertial pos="0.1 0 -0.3" mass="1" diaginertia="0.02 0.02 0.01"/></body></worldbody>
       <actuator><motor name="u" joint="j"/></actuator>
       <sensor><jointpos name="y" joint="j"/></sensor>)"},
};

}  // namespace mjdiag::test
