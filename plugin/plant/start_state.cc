#include "mjdiag/plugin/plant/start_state.h"

#include <vector>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr int kIterations = 20;

double LargestError(const Eigen::VectorXd& error, const Eigen::VectorXd& target) {
  return (error.array().abs() / (1e-12 + 1e-9 * target.array().abs())).maxCoeff();
}

/// Those sensors only that have a start reading and read a position.
Channels PositionSensors(const Channels& channels, const mjModel& model,
                         const std::map<std::string, double>& start) {
  Channels placed = channels;
  std::erase_if(placed.sensors, [&](const SensorSetup& sensor) {
    const int id = FindElement(model, mjOBJ_SENSOR, sensor.element);
    return !start.contains(sensor.channel) || model.sensor_needstage[id] != mjSTAGE_POS;
  });
  return placed;
}

}  // namespace

Eigen::VectorXd SensorReadings(const Channels& channels, const mjModel& model,
                               const Eigen::VectorXd& qpos) {
  const DataPtr data = MakeData(model);
  return SensorReadings(channels, model, qpos, *data);
}

Eigen::VectorXd SensorReadings(const Channels& channels, const mjModel& model,
                               const Eigen::VectorXd& qpos, mjData& data) {
  Eigen::Map<Eigen::VectorXd>(data.qpos, model.nq) = qpos;
  mj_fwdPosition(&model, &data);
  mj_sensorPos(&model, &data);
  const std::vector<int> addresses = SensorAddresses(channels, model);
  Eigen::VectorXd readings(static_cast<Eigen::Index>(addresses.size()));
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    readings[static_cast<Eigen::Index>(i)] = data.sensordata[addresses[i]];
  }
  return readings;
}

Eigen::VectorXd StartPosition(const Channels& channels, const mjModel& model,
                              const Eigen::VectorXd& rest,
                              const std::map<std::string, double>& start) {
  Eigen::VectorXd qpos = rest;
  if (start.empty()) return qpos;

  const Channels placed = PositionSensors(channels, model, start);
  const auto sensors = static_cast<Eigen::Index>(placed.sensors.size());
  if (sensors == 0) return qpos;
  Eigen::VectorXd target(sensors);
  for (Eigen::Index i = 0; i < sensors; ++i) {
    target[i] = start.at(placed.sensors[static_cast<std::size_t>(i)].channel);
  }
  const Eigen::MatrixXd rows = OutputMatrix(model, placed, qpos).transpose();

  Eigen::VectorXd weight(model.nv);
  for (int dof = 0; dof < model.nv; ++dof) {
    weight[dof] = 1.0 / (1.0 + model.jnt_stiffness[model.dof_jntid[dof]]);
  }
  const Eigen::MatrixXd weighted = weight.asDiagonal() * rows.transpose();
  const Eigen::MatrixXd step = weighted * PseudoInverse(rows * weighted);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::VectorXd error = target - SensorReadings(placed, model, qpos);
    if (LargestError(error, target) <= 1.0) return qpos;
    qpos += step * error;
  }
  throw NumericalError("start: no joint positions give the sensors' first readings");
}

}  // namespace mjdiag
