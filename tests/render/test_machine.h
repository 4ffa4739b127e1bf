#pragma once
// A small machine for the tests of render/: a driven slide on a compliant one and a
// driven hinge that has a soft spring of its own, with records of its joints; and
// scenes of a few bodies.

#include <cmath>
#include <numbers>
#include <string>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/render/diagnosis_overlay.h"
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
      <site name="corner" pos="0.2 0.1 0.02" group="4"/>
      <body pos="0 0 0.05">
        <joint name="stage" type="slide" axis="1 0 0"/>
        <geom type="box" size="0.05 0.05 0.03" rgba="0.8 0.4 0.1 1"/>
        <body pos="0 0 0.05">
          <joint name="tilt" type="hinge" axis="0 0 1" stiffness="1e6"/>
          <geom type="box" size="0.01 0.03 0.02" rgba="0.1 0.4 0.8 1"/>
          <body pos="0 0 0.03">
            <joint name="arm" type="hinge" axis="0 1 0" stiffness="1.5"/>
            <geom type="capsule" size="0.008" fromto="0 0 0 0.08 0 0"/>
            <site name="elbow" pos="0 0 0" group="4"/>
            <site name="tip" pos="0.08 0 0" group="4"/>
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

/// Bodies and a camera "front" at y = -1 that looks along y, with a field of view of 2
/// atan(1/2): at a distance d [m] a picture h pixels high is d [m] high.
inline ModelPtr ModelInView(const std::string& bodies) {
  const TemporaryFolder folder;
  return LoadModel(
      folder.Write("model.xml",
                   "<mujoco><worldbody>"
                   "<camera name='front' pos='0 -1 0' xyaxes='1 0 0 0 0 1' "
                   "fovy='53.13010235415598'/>" +
                       bodies + "</worldbody></mujoco>"));
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

/// A diagnosis of the second of two runs: the residual leaves its limits 2.5 .. -1.5 at
/// 41 ms; "damping" is off healthy, "force" is not, "gap" is never determined.
inline DiagnosisOverlay Overlay() {
  DiagnosisOverlay overlay;
  overlay.run = 1;
  overlay.residual = Record(1e-3);
  const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(101, 0.0, 100.0);
  overlay.residual.Add({"residual", "1", 3.0 * (ramp.array() / 50.0).matrix()});
  overlay.limit_low = -1.5;
  overlay.limit_high = 2.5;
  overlay.detection = 0.041;
  constexpr Eigen::Index kEstimates = 11;
  overlay.estimate_time = Eigen::VectorXd::LinSpaced(kEstimates, 0.0, 0.1);
  const Eigen::VectorXd shrinking =
      (0.5 / (1.0 + Eigen::ArrayXd::LinSpaced(kEstimates, 0.0, 10.0))).matrix();
  const auto constant = [&](double value) {
    return Eigen::VectorXd::Constant(kEstimates, value).eval();
  };
  overlay.estimates = {{"damping", 1.0, constant(1.2), shrinking},
                       {"force", 0.0, constant(-0.01), shrinking},
                       {"gap", 1.0, constant(std::nan("")), constant(std::nan(""))}};
  return overlay;
}

}  // namespace mjdiag::test
