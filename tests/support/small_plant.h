#pragma once
// Plants that a test writes as text.

#include <string>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "support/temporary_folder.h"

namespace mjdiag::test {

inline ModelPtr PlantOf(const std::string& mjcf) {
  const TemporaryFolder folder;
  return LoadModel(folder.Write("small.xml", mjcf));
}

/// @param mjcf  what is inside <mujoco>; angles in rad, constraints solved to 1e-12
inline ModelPtr SmallPlant(const std::string& mjcf) {
  const TemporaryFolder folder;
  return LoadModel(folder.Write("small.xml",
                                "<mujoco model=\"small\"><compiler angle=\"radian\" "
                                "autolimits=\"true\"/><option timestep=\"0.001\" "
                                "tolerance=\"1e-12\"/>" +
                                    mjcf + "</mujoco>"));
}

/// A foot on a leg with a spring, below a body, on a floor.
inline const std::string kHopper = R"(<worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="body" pos="0 0 0.45">
      <joint name="height" type="slide" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="4" diaginertia="0.02 0.02 0.02"/>
      <body name="leg" pos="0 0 -0.2">
        <joint name="leg" type="slide" axis="0 0 1" stiffness="4000" damping="30"/>
        <inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.002 0.002 0.0002"/>
        <geom name="foot" type="sphere" size="0.05" pos="0 0 -0.2" solref="0.005 1"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="thrust" joint="leg"/></actuator>
  <sensor><jointpos name="height" joint="height"/></sensor>)";

/// Two slides of 4 kg that an equality ties, driven at the first.
inline std::string Gantry(double ratio) {
  return R"(<worldbody>
    <body pos="0 -.3 0"><joint name="y1" type="slide" axis="1 0 0" damping="60"/>
      <inertial pos="0 0 0" mass="4" diaginertia=".1 .1 .1"/></body>
    <body pos="0 .3 0"><joint name="y2" type="slide" axis="1 0 0" damping="60"/>
      <inertial pos="0 0 0" mass="4" diaginertia=".1 .1 .1"/></body>
  </worldbody>
  <equality><joint joint1="y2" joint2="y1" polycoef="0 )" +
         std::to_string(ratio) + R"( 0 0 0" solref="0.002 1"/></equality>
  <actuator><motor name="m1" joint="y1"/></actuator>
  <sensor><jointpos name="y1" joint="y1"/><jointpos name="y2" joint="y2"/></sensor>)";
}

/// A body with four rotors, free.
inline const std::string kQuadrotor = R"(<worldbody><body name="x2" pos="0 0 0.3">
      <freejoint name="base"/>
      <inertial pos="0 0 0" mass="1.3" diaginertia="0.04 0.03 0.06"/>
      <site name="imu"/><site name="m1" pos="-.14 -.18 .05"/>
      <site name="m2" pos="-.14 .18 .05"/><site name="m3" pos=".14 .18 .05"/>
      <site name="m4" pos=".14 -.18 .05"/>
    </body></worldbody>
  <actuator>
    <motor name="t1" site="m1" gear="0 0 1 0 0 -.02"/>
    <motor name="t2" site="m2" gear="0 0 1 0 0 .02"/>
    <motor name="t3" site="m3" gear="0 0 1 0 0 -.02"/>
    <motor name="t4" site="m4" gear="0 0 1 0 0 .02"/>
  </actuator>
  <sensor><framepos name="pos" objtype="site" objname="imu"/>
    <gyro name="gyro" site="imu"/><framequat name="quat" objtype="site" objname="imu"/>
    <accelerometer name="acc" site="imu"/></sensor>)";

}  // namespace mjdiag::test
