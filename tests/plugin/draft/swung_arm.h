#pragma once
// An arm that a torque swings, and its log as a logger may have left it.

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "support/temporary_folder.h"

namespace mjdiag::test {

/// Inside <mujoco>: a link that hangs, 1 kg at 0.2 m. @param more  behind the world
inline std::string Arm(const std::string& more,
                       const std::string& option = R"(<option timestep="0.001"/>)") {
  return "<mujoco model=\"arm\">" + option + R"(
  <!-- as drawn -->
  <worldbody>
    <body name="link" pos="0 0 1">
      <joint name="hinge" axis="0 1 0" damping="0.05"/>
      <inertial pos="0 0 -0.2" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body>
  </worldbody>
)" + more +
         "</mujoco>\n";
}

inline const std::string kMotor =
    "<actuator><motor name=\"motor\" joint=\"hinge\"/></actuator>\n";
inline const std::string kEncoder =
    "<sensor><jointpos name=\"encoder\" joint=\"hinge\"/></sensor>\n";

/// One moment of it.
struct SwungMoment {
  double time;    ///< [s]
  double angle;   ///< [rad]
  double speed;   ///< [rad/s]
  double torque;  ///< [N m], which was commanded
};

/// Four seconds at 500 Hz, torques of two tones.
/// @param row    a line of the log for each moment
/// @param delay  ticks of 2 ms by which the torque acts later
inline std::string SwungLog(const std::string& header,
                            const std::function<std::string(const SwungMoment&)>& row,
                            int delay = 0) {
  const TemporaryFolder folder;
  const ModelPtr model = LoadModel(folder.Write("arm.xml", Arm(kMotor)));
  const DataPtr data = MakeData(*model);
  const auto torque = [](int k) {
    return k < 0 ? 0.0 : 1.2 * std::sin(0.011 * k) + 0.8 * std::sin(0.047 * k);
  };
  std::string text = header + "\n";
  for (int k = 0; k < 2000; ++k) {
    text += row({0.002 * k, data->qpos[0], data->qvel[0], torque(k)}) + "\n";
    data->ctrl[0] = torque(k - delay);
    mj_step(model.get(), data.get());
    mj_step(model.get(), data.get());
  }
  return text;
}

/// Numbers with commas between.
template <typename... Number>
std::string Row(Number... numbers) {
  std::string text;
  const auto add = [&text](double number) {
    std::array<char, 32> word{};
    std::snprintf(word.data(), word.size(), "%.9g", number);
    text += (text.empty() ? "" : ",") + std::string(word.data());
  };
  (add(numbers), ...);
  return text;
}

}  // namespace mjdiag::test
