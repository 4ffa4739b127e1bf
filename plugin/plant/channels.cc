#include "mjdiag/plugin/plant/channels.h"

#include <string>
#include <utility>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

std::vector<int> SensorAddresses(const Channels& channels, const mjModel& model) {
  std::vector<int> addresses;
  for (const SensorSetup& sensor : channels.sensors) {
    const int id = FindElement(model, mjOBJ_SENSOR, sensor.element);
    if (sensor.component < 0 || sensor.component >= model.sensor_dim[id]) {
      throw InputError(
          "sensors." + sensor.channel + ".component",
          std::to_string(sensor.component) + " is not in '" + sensor.element + "'",
          "0 to " + std::to_string(model.sensor_dim[id] - 1));
    }
    addresses.push_back(model.sensor_adr[id] + sensor.component);
  }
  return addresses;
}

std::vector<int> ActuatorAddresses(const Channels& channels, const mjModel& model) {
  std::vector<int> addresses;
  for (const ActuatorSetup& actuator : channels.actuators) {
    addresses.push_back(FindElement(model, mjOBJ_ACTUATOR, actuator.element));
  }
  return addresses;
}

mjtStage StageOf(const mjModel& model, const SensorSetup& sensor) {
  const int id = FindElement(model, mjOBJ_SENSOR, sensor.element);
  return static_cast<mjtStage>(model.sensor_needstage[id]);
}

Channel JointChannel(const mjModel& model, int joint, Eigen::VectorXd samples) {
  return {"joint." + ElementName(model, mjOBJ_JOINT, joint),
          model.jnt_type[joint] == mjJNT_SLIDE ? "m" : "rad", std::move(samples)};
}

}  // namespace mjdiag
