#pragma once
// A small machine for the tests of render/: a driven slide on a compliant one and a
// driven hinge that has a soft spring of its own, with records of its joints.

#include <cmath>
#include <numbers>
#include <string>

#include "mjdiag/plugin/mujoco_model.h"
#include "mjdiag/signals/record.h"
#include "support/temporary_folder.h"

namespace mjdiag::test {

inline constexpr const char* kMachine = R"(<mujoco>
  <worldbody>
    <light pos="0 -1 2" dir="0 0.4 -1" directional="true"/>
    <camera name="front" pos="0 -1 0.3" xyaxes="1 0 0 0 0.3 1"/>
    <camera name="top" pos="0 0 1.2"/>
    <body>
      <joint name="mount" type="slide" axis="1 0 0" stiffness="1e8"/>
      <geom type="box" size="0.2 0.1 0.02" rgba="0.3 0.3 0.35 1"/>
      <body pos="0 0 0.05">
        <joint name="stage" type="slide" axis="1 0 0"/>
        <geom type="box" size="0.05 0.05 0.03" rgba="0.8 0.4 0.1 1"/>
        <body pos="0 0 0.05">
          <joint name="tilt" type="hinge" axis="0 0 1" stiffness="1e6"/>
          <geom type="box" size="0.01 0.03 0.02" rgba="0.1 0.4 0.8 1"/>
          <body pos="0 0 0.03">
            <joint name="arm" type="hinge" axis="0 1 0" stiffness="1.5"/>
            <geom type="capsule" size="0.008" fromto="0 0 0 0.08 0 0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="lift">
      <joint joint="tilt" coef="1"/>
      <joint joint="arm" coef="1"/>
    </fixed>
  </tendon>
  <actuator>
    <motor joint="stage"/>
    <motor tendon="lift"/>
  </actuator>
</mujoco>)";

inline ModelPtr Machine() {
  const TemporaryFolder folder;
  return LoadModel(folder.Write("machine.xml", kMachine));
}

/// A run of `samples` at 1 kHz: joints with the given peak deviations, and axis "x"
/// with its reference.
struct RunSpec {
  double mount = 2e-8;  ///< [m]
  double tilt = 3e-8;   ///< [rad]
  double stage = 1e-6;  ///< off the reference [m]
  double arm = 1e-5;    ///< off the reference [rad]
  Eigen::Index samples = 101;
};

inline Record Run(const RunSpec& spec) {
  Record record(1e-3);
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(
      spec.samples, 0.0, 1e-3 * static_cast<double>(spec.samples - 1));
  const Eigen::VectorXd wave =
      (2.0 * std::numbers::pi * 25.0 * time).array().sin().matrix();
  const Eigen::VectorXd stroke = 0.02 * time / 0.1;
  const Eigen::VectorXd stage = stroke + spec.stage * wave;
  record.Add({"joint.mount", "m", spec.mount * wave});
  record.Add({"joint.stage", "m", stage});
  record.Add({"joint.tilt", "rad", spec.tilt * wave});
  record.Add({"joint.arm", "rad", 2.0 * stroke + spec.arm * wave});
  record.Add({"x", "m", stage});
  record.Add({"x_ref", "m", stroke});
  return record;
}

}  // namespace mjdiag::test
