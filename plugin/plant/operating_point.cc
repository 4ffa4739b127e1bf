#include "mjdiag/plugin/plant/operating_point.h"

#include <algorithm>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/constraint_rows.h"
#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Sets what an actuator's force is proportional to, and the control that keeps it there.
/// False if it cannot be that.
bool Drive(const mjModel& model, mjData& data, int actuator, double value) {
  DriveOf(model, data, actuator) = value;
  const int type = model.actuator_dyntype[actuator];
  data.ctrl[actuator] = type == mjDYN_INTEGRATOR ? 0.0 : value;
  if (type == mjDYN_MUSCLE && (value < 0.0 || value > 1.0)) return false;
  if (model.actuator_ctrllimited[actuator] == 0) return true;
  const mjtNum* range = RowOf(model.actuator_ctrlrange, 2, actuator);
  return data.ctrl[actuator] >= range[0] && data.ctrl[actuator] <= range[1];
}

/// On independent coordinates alone, with the same effect.
VectorXd OnIndependent(const Independence& ties, const VectorXd& force) {
  VectorXd on = VectorXd::Zero(force.size());
  on(ties.independent) = ties.T.transpose() * force;
  return on;
}

OperatingPoint PointOf(const mjModel& model, const mjData& data) {
  OperatingPoint point;
  point.qpos = VectorXd::Map(data.qpos, model.nq);
  point.velocity = VectorXd::Map(data.qvel, model.nv);
  point.acceleration = VectorXd::Zero(model.nv);
  point.activation = VectorXd::Map(data.act, model.na);
  point.controls = VectorXd::Map(data.ctrl, model.nu);
  point.applied_force = VectorXd::Zero(model.nv);
  point.holding_force = VectorXd::Zero(model.nv);
  return point;
}

/// Tries to hold a configuration by the actuators. False if they cannot.
/// @param force  that is to be balanced on independent coordinates
bool HoldByActuators(const Independence& ties, const std::vector<int>& actuators,
                     const VectorXd& force, PlantForces& forces) {
  constexpr double kBalanced = 1e-9;
  const mjModel& model = forces.model();
  mjData& data = forces.data();
  const VectorXd off = forces.Smooth();
  MatrixXd gain(ties.T.cols(), static_cast<Index>(actuators.size()));
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    // A unit may be beyond the range, a thousandth of it not.
    constexpr double kPart = 1e-3;
    Drive(model, data, actuators[i], kPart);
    gain.col(static_cast<Index>(i)) =
        ties.T.transpose() * (forces.Smooth() - off) / kPart;
    Drive(model, data, actuators[i], 0.0);
  }
  const VectorXd wanted = ties.T.transpose() * force;
  const VectorXd drives = LeastNorm(gain, -wanted);
  bool can = true;
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    can = Drive(model, data, actuators[i], drives[static_cast<Index>(i)]) && can;
  }
  const VectorXd left = ties.T.transpose() * (forces.Smooth() - off) + wanted;
  if (can && left.norm() <= kBalanced * wanted.norm()) return true;
  for (const int actuator : actuators) Drive(model, data, actuator, 0.0);
  return false;
}

}  // namespace

int ActivationOf(const mjModel& model, int actuator) {
  // MuJoCo puts actuators with an activation behind those without.
  const auto first = static_cast<int>(model.nu - model.na);
  return actuator < first ? -1 : actuator - first;
}

mjtNum& DriveOf(const mjModel& model, mjData& data, int actuator) {
  const int activation = ActivationOf(model, actuator);
  return activation < 0 ? data.ctrl[actuator] : data.act[activation];
}

void Set(const mjModel& model, const OperatingPoint& point, mjData& data) {
  VectorXd::Map(data.qpos, model.nq) = point.qpos;
  VectorXd::Map(data.qvel, model.nv) = point.velocity;
  VectorXd::Map(data.act, model.na) = point.activation;
  VectorXd::Map(data.ctrl, model.nu) = point.controls;
  VectorXd::Map(data.qfrc_applied, model.nv) = point.applied_force;
}

OperatingPoint HeldAt(const mjModel& model, const Channels& channels,
                      const RestPose& pose) {
  PlantForces forces(model, pose.qpos);
  if (pose.rests) {
    OperatingPoint point = PointOf(model, forces.data());
    point.rests = true;
    return point;
  }
  forces.Total();
  const Independence ties = IndependentCoordinates(model, channels, forces.data());
  const VectorXd off = forces.Smooth();
  const bool held =
      HoldByActuators(ties, ActuatorAddresses(channels, model), off, forces);
  OperatingPoint point = PointOf(model, forces.data());
  const VectorXd by_actuators = forces.Smooth() - off;
  if (!held) point.applied_force = -OnIndependent(ties, off);
  point.holding_force = by_actuators + point.applied_force;
  return point;
}

OperatingPoint MovingAt(const mjModel& model, const Channels& channels,
                        const VectorXd& qpos, const VectorXd& velocity,
                        const VectorXd& acceleration, const VectorXd& inputs) {
  PlantForces forces(model, qpos);
  forces.Total();
  const Independence ties = IndependentCoordinates(model, channels, forces.data());
  mjData& data = forces.data();
  VectorXd::Map(data.qvel, model.nv) = velocity;
  const VectorXd off = forces.Smooth();
  const std::vector<int> actuators = ActuatorAddresses(channels, model);
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const double input = inputs[static_cast<Index>(i)];
    Drive(model, data, actuators[i],
          model.actuator_dyntype[actuators[i]] == mjDYN_INTEGRATOR ? 0.0 : input);
    data.ctrl[actuators[i]] = input;
  }
  const VectorXd on = forces.Smooth();
  OperatingPoint point = PointOf(model, data);
  point.acceleration = acceleration;
  point.applied_force = OnIndependent(ties, forces.Mass() * acceleration - on);
  point.holding_force = on - off + point.applied_force;
  return point;
}

}  // namespace mjdiag
