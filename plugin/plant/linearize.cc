#include "mjdiag/plugin/plant/linearize.h"

#include <algorithm>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd JointDamping(const mjModel& model) {
  VectorXd damping = VectorXd::Map(model.dof_damping, model.nv);
  if ((model.opt.disableflags & mjDSBL_PASSIVE) != 0) damping.setZero();
  return damping.asDiagonal();
}

ModelPtr WithoutLimits(const mjModel& model) {
  ModelPtr unlimited = CopyModel(model);
  std::fill_n(unlimited->actuator_ctrllimited, unlimited->nu, mjtByte{0});
  std::fill_n(unlimited->actuator_forcelimited, unlimited->nu, mjtByte{0});
  return unlimited;
}

/// Generalised forces per unit of the setup's actuator signals, or of the activations that
/// they lead to.
/// @param model  WithoutLimits
MatrixXd InputMatrix(const mjModel& model, const Channels& channels,
                     const VectorXd& position, const VectorXd& velocity) {
  PlantForces forces(model, position);
  VectorXd::Map(forces.data().qvel, model.nv) = velocity;
  forces.Update();
  const VectorXd at_rest = VectorXd::Map(forces.data().qfrc_actuator, model.nv);
  MatrixXd gamma(model.nv, static_cast<Index>(channels.actuators.size()));
  const std::vector<int> actuators = ActuatorAddresses(channels, model);
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    mjtNum& drive = DriveOf(model, forces.data(), actuators[i]);
    drive = 1.0;
    forces.Update();
    gamma.col(static_cast<Index>(i)) =
        VectorXd::Map(forces.data().qfrc_actuator, model.nv) - at_rest;
    drive = 0.0;
  }
  return gamma;
}

/// What the sensors read, where the forces are.
auto ReadingsAt(const Channels& channels, PlantForces& forces) {
  return
      [&forces, addresses = SensorAddresses(channels, forces.model())]() -> VectorXd {
        forces.Update();
        return VectorXd::Map(forces.data().sensordata,
                             forces.model().nsensordata)(addresses);
      };
}

/// Columns of sensors of a stage; 0 of others.
MatrixXd ColumnsOf(mjtStage stage, MatrixXd columns, const mjModel& model,
                   const Channels& channels) {
  for (std::size_t i = 0; i < channels.sensors.size(); ++i) {
    if (StageOf(model, channels.sensors[i]) == stage) continue;
    columns.col(static_cast<Index>(i)).setZero();
  }
  return columns;
}

}  // namespace

MatrixXd OutputMatrix(const mjModel& model, const Channels& channels,
                      const VectorXd& position) {
  PlantForces forces(model, position);
  return ColumnsOf(mjSTAGE_POS,
                   ByPosition(forces, ReadingsAt(channels, forces)).transpose(), model,
                   channels);
}

MatrixXd VelocityOutputMatrix(const mjModel& model, const Channels& channels,
                              const VectorXd& position) {
  PlantForces forces(model, position);
  return ColumnsOf(mjSTAGE_VEL,
                   ByVelocity(forces, ReadingsAt(channels, forces)).transpose(), model,
                   channels);
}

MechanicalModel Linearize(const mjModel& model, const Channels& channels,
                          const VectorXd& rest) {
  return MotionLinearization(model, channels)
      .At({rest, VectorXd::Zero(model.nv), VectorXd::Zero(model.nv),
           VectorXd::Zero(static_cast<Index>(channels.actuators.size()))});
}

void RequireScalarJoints(const mjModel& model, const Channels& channels) {
  if (model.opt.integrator == mjINT_RK4) {
    throw InputError("integrator RK4", "is not what the linear plant is stepped by",
                     R"(integrator="Euler" or "implicit")");
  }
  for (int joint = 0; joint < model.njnt; ++joint) {
    const int type = model.jnt_type[joint];
    if (type == mjJNT_SLIDE || type == mjJNT_HINGE) continue;
    throw InputError("joint " + ElementName(model, mjOBJ_JOINT, joint),
                     "turns in three dimensions", "a slide or hinge joint");
  }
  for (const int actuator : ActuatorAddresses(channels, model)) {
    if (model.actuator_dyntype[actuator] == mjDYN_NONE) continue;
    throw InputError("actuator " + ElementName(model, mjOBJ_ACTUATOR, actuator),
                     "has dynamics of its own", "dyntype \"none\"");
  }
  for (const SensorSetup& sensor : channels.sensors) {
    if (StageOf(model, sensor) == mjSTAGE_POS) continue;
    throw InputError("sensor " + sensor.element, "does not read a position",
                     "a position sensor");
  }
}

// Models are copied once: one with meshes is large.
MotionLinearization::MotionLinearization(const mjModel& model, const Channels& channels)
    : model_(model),
      channels_(channels),
      bare_(WithoutJointSprings(model)),
      unlimited_(WithoutLimits(model)) {
  DropScenery(*bare_);
  DropScenery(*unlimited_);
}

MechanicalModel MotionLinearization::At(const MotionPoint& point) const {
  OperatingPoint at;
  at.qpos = point.position;
  at.velocity = point.velocity;
  at.acceleration = point.acceleration;
  at.activation = VectorXd::Zero(model_.na);
  at.controls = VectorXd::Zero(model_.nu);
  const std::vector<int> actuators = ActuatorAddresses(channels_, model_);
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const int activation = ActivationOf(model_, actuators[i]);
    const double input = point.inputs[static_cast<Index>(i)];
    if (activation < 0) {
      at.controls[actuators[i]] = input;
    } else {
      at.activation[activation] = input;
    }
  }
  at.applied_force = VectorXd::Zero(model_.nv);
  return About(at);
}

MechanicalModel MotionLinearization::About(const OperatingPoint& point) const {
  PlantForces forces(*bare_, point.qpos);
  mjData& data = forces.data();
  Set(*bare_, point, data);
  VectorXd inertial(model_.nv);
  MechanicalModel result;
  result.K = -ByPosition(forces, [&]() -> VectorXd {
    const VectorXd force = forces.Smooth();
    mj_mulM(bare_.get(), &data, inertial.data(), point.acceleration.data());
    return force - inertial;
  });
  result.K += ScalarSprings(model_).asDiagonal();
  result.D = JointDamping(model_) - ByVelocity(forces, [&] { return forces.Smooth(); });
  result.coordinates = CoordinateNames(model_);
  result.inputs = ChannelsOf(channels_.actuators);
  result.outputs = ChannelsOf(channels_.sensors);
  result.M = PlantForces(*bare_, point.qpos).Mass();
  result.Gamma = InputMatrix(*unlimited_, channels_, point.qpos, point.velocity);
  result.b = OutputMatrix(*bare_, channels_, point.qpos);
  return result;
}

}  // namespace mjdiag
