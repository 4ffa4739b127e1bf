#include "mjdiag/plugin/plant/linearize.h"

#include <algorithm>
#include <functional>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void RequireSlidesAndHinges(const mjModel& model) {
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (model.jnt_type[joint] == mjJNT_SLIDE || model.jnt_type[joint] == mjJNT_HINGE) {
      continue;
    }
    throw InputError("joint " + ElementName(model, mjOBJ_JOINT, joint),
                     "cannot be linearised", "a slide or hinge joint");
  }
}

/// The stages of mj_forward up to the smooth forces. Constraints, and static friction
/// with them, are left out. The control callback is not called either, which would act
/// on the controls and is shared with simulations in other threads.
class SmoothDynamics {
 public:
  SmoothDynamics(const mjModel& model, const VectorXd& position)
      : model_(model), data_(MakeData(model)) {
    VectorXd::Map(data_->qpos, model.nq) = position;
  }

  mjData& data() { return *data_; }
  int size() const { return static_cast<int>(model_.nv); }

  /// Evaluates positions, velocities and controls as they are in the data.
  void Update() {
    mj_fwdPosition(&model_, data_.get());
    mj_sensorPos(&model_, data_.get());
    mj_fwdVelocity(&model_, data_.get());
    mj_fwdActuation(&model_, data_.get());
  }

  /// Generalised force that accelerates the machine.
  VectorXd Force() {
    Update();
    const auto map = [&](const mjtNum* vector) {
      return VectorXd::Map(vector, size());
    };
    return map(data_->qfrc_passive) - map(data_->qfrc_bias) + map(data_->qfrc_actuator);
  }

  MatrixXd Mass() {
    Update();
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> mass(size(),
                                                                                size());
    mj_fullM(&model_, mass.data(), data_->qM);
    return mass;
  }

 private:
  const mjModel& model_;
  DataPtr data_;
};

/// d function / d argument, column by column, by the central difference of sixth order.
/// The step balances truncation, step^6 / 140, against rounding, eps / step, for
/// functions that change over lengths of order one, as those of a kinematic chain do.
MatrixXd Differentiate(const std::function<VectorXd()>& function, mjtNum* argument,
                       int arguments) {
  constexpr double kStep = 1e-2;
  constexpr double kWeights[] = {45.0, -9.0, 1.0};
  MatrixXd jacobian;
  for (int j = 0; j < arguments; ++j) {
    const double at = argument[j];
    const auto value = [&](int steps) {
      argument[j] = at + steps * kStep;
      return function();
    };
    VectorXd sum;
    for (int k = 1; k <= 3; ++k) {
      const VectorXd difference = kWeights[k - 1] * (value(k) - value(-k));
      sum = k == 1 ? difference : (sum + difference).eval();
    }
    argument[j] = at;
    if (j == 0) jacobian.resize(sum.size(), arguments);
    jacobian.col(j) = sum / (60.0 * kStep);
  }
  return jacobian;
}

/// A copy of the model in which joints have neither springs nor dampers. What those
/// contribute is known exactly, and 1e8 N/m of mount stiffness would bury the gravity
/// stiffness of 1e-2 N m/rad in rounding.
ModelPtr WithoutJointSprings(const mjModel& model) {
  ModelPtr copy = CopyModel(model);
  mju_zero(copy->jnt_stiffness, copy->njnt);
  mju_zero(copy->dof_damping, static_cast<int>(copy->nv));
  return copy;
}

MatrixXd JointDamping(const mjModel& model) {
  return Eigen::Map<const VectorXd>(model.dof_damping, model.nv).asDiagonal();
}

/// Stiffness of everything but the joint springs: gravity, tendons, actuator bias.
/// @param bare  WithoutJointSprings
MatrixXd GeometricStiffness(const mjModel& bare, const VectorXd& position) {
  SmoothDynamics dynamics(bare, position);
  return -Differentiate([&] { return dynamics.Force(); }, dynamics.data().qpos,
                        dynamics.size());
}

/// Damping of everything but the joint dampers. Terms quadratic in the velocity cancel
/// in central differences.
/// @param bare  WithoutJointSprings
MatrixXd OtherDamping(const mjModel& bare, const VectorXd& position) {
  SmoothDynamics dynamics(bare, position);
  return -Differentiate([&] { return dynamics.Force(); }, dynamics.data().qvel,
                        dynamics.size());
}

ModelPtr WithoutLimits(const mjModel& model) {
  ModelPtr unlimited = CopyModel(model);
  std::fill_n(unlimited->actuator_ctrllimited, unlimited->nu, mjtByte{0});
  std::fill_n(unlimited->actuator_forcelimited, unlimited->nu, mjtByte{0});
  return unlimited;
}

/// Generalised forces per unit of the setup's actuator signals.
/// @param model  WithoutLimits
MatrixXd InputMatrix(const mjModel& model, const Channels& channels,
                     const VectorXd& position) {
  SmoothDynamics dynamics(model, position);
  dynamics.Update();
  const VectorXd at_rest = VectorXd::Map(dynamics.data().qfrc_actuator, model.nv);
  MatrixXd gamma(model.nv, static_cast<Index>(channels.actuators.size()));
  const std::vector<int> actuators = ActuatorAddresses(channels, model);
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const int actuator = actuators[i];
    if (model.actuator_dyntype[actuator] != mjDYN_NONE) {
      throw InputError("actuator " + channels.actuators[i].element,
                       "has dynamics of its own", "dyntype \"none\"");
    }
    dynamics.data().ctrl[actuator] = 1.0;
    dynamics.Update();
    gamma.col(static_cast<Index>(i)) =
        VectorXd::Map(dynamics.data().qfrc_actuator, model.nv) - at_rest;
    dynamics.data().ctrl[actuator] = 0.0;
  }
  return gamma;
}

void RequirePositionSensors(const mjModel& model, const Channels& channels) {
  for (const SensorSetup& sensor : channels.sensors) {
    const int id = FindElement(model, mjOBJ_SENSOR, sensor.element);
    if (model.sensor_needstage[id] == mjSTAGE_POS) continue;
    throw InputError("sensor " + sensor.element, "does not read a position",
                     "a position sensor");
  }
}

}  // namespace

MatrixXd OutputMatrix(const mjModel& model, const Channels& channels,
                      const VectorXd& position) {
  RequirePositionSensors(model, channels);
  const std::vector<int> addresses = SensorAddresses(channels, model);
  SmoothDynamics dynamics(model, position);
  const auto readings = [&]() -> VectorXd {
    dynamics.Update();
    return VectorXd::Map(dynamics.data().sensordata, model.nsensordata)(addresses);
  };
  return Differentiate(readings, dynamics.data().qpos, dynamics.size()).transpose();
}

namespace {

/// The displacement that balances a force; coordinates that nothing holds are left
/// where they are. Scaling by the masses makes slides and hinges comparable.
VectorXd NewtonStep(const MatrixXd& stiffness, const VectorXd& mass,
                    const VectorXd& force) {
  const VectorXd scale = mass.cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
  return scale.asDiagonal() * LeastNorm(scaled, scale.asDiagonal() * force);
}

/// A joint that nothing holds is at rest only without force.
void RequireRest(const mjModel& model, const VectorXd& acceleration) {
  constexpr double kAtRest = 1e-6;  // m/s^2 or rad/s^2
  Index joint = 0;
  if (acceleration.cwiseAbs().maxCoeff(&joint) < kAtRest) return;
  throw NumericalError("no static equilibrium: nothing holds joint " +
                       ElementName(model, mjOBJ_JOINT, static_cast<int>(joint)));
}

}  // namespace

VectorXd StaticEquilibrium(const mjModel& model) {
  RequireSlidesAndHinges(model);
  VectorXd position = VectorXd::Map(model.qpos0, model.nq);
  SmoothDynamics dynamics(model, position);
  const VectorXd mass = dynamics.Mass().diagonal();
  const MatrixXd springs(JointStiffness(model).asDiagonal());
  const ModelPtr bare = WithoutJointSprings(model);
  const auto force_at = [&](const VectorXd& at) {
    VectorXd::Map(dynamics.data().qpos, at.size()) = at;
    return dynamics.Force();
  };
  VectorXd force = force_at(position);
  constexpr int kIterations = 50;
  constexpr double kTolerance = 1e-13;  // m or rad
  // A step that does not help any more is what rounding leaves.
  constexpr double kRounding = 1e-9;
  for (int i = 0; i < kIterations; ++i) {
    const VectorXd step =
        NewtonStep(springs + GeometricStiffness(*bare, position), mass, force);
    if (step.cwiseAbs().maxCoeff() <= kTolerance) {
      RequireRest(model, force.cwiseQuotient(mass));
      return position + step;
    }
    double fraction = 1.0;
    VectorXd next = force_at(position + step);
    while (next.norm() >= force.norm() && fraction > 1e-6) {
      fraction *= 0.5;
      next = force_at(position + fraction * step);
    }
    if (next.norm() >= force.norm() && step.cwiseAbs().maxCoeff() <= kRounding) {
      RequireRest(model, force.cwiseQuotient(mass));
      return position;
    }
    position += fraction * step;
    force = next;
  }
  throw NumericalError("no static equilibrium: the search did not converge");
}

MechanicalModel Linearize(const mjModel& model, const Channels& channels,
                          const VectorXd& rest) {
  RequireSlidesAndHinges(model);
  MechanicalModel result;
  for (int joint = 0; joint < model.njnt; ++joint) {
    result.coordinates.push_back(ElementName(model, mjOBJ_JOINT, joint));
  }
  result.inputs = ChannelsOf(channels.actuators);
  result.outputs = ChannelsOf(channels.sensors);
  result.M = SmoothDynamics(model, rest).Mass();
  const ModelPtr bare = WithoutJointSprings(model);
  result.D = JointDamping(model) + OtherDamping(*bare, rest);
  result.K = GeometricStiffness(*bare, rest);
  result.K += JointStiffness(model).asDiagonal();
  result.Gamma = InputMatrix(*WithoutLimits(model), channels, rest);
  result.b = OutputMatrix(model, channels, rest);
  return result;
}

// Models are copied once: one with meshes is large.
MotionLinearization::MotionLinearization(const mjModel& model, const Channels& channels)
    : model_(model),
      channels_(channels),
      bare_(WithoutJointSprings(model)),
      unlimited_(WithoutLimits(model)) {
  RequireSlidesAndHinges(model);
  DropScenery(*bare_);
  DropScenery(*unlimited_);
}

MechanicalModel MotionLinearization::At(const MotionPoint& point) const {
  const std::vector<int> actuators = ActuatorAddresses(channels_, model_);
  SmoothDynamics dynamics(*bare_, point.position);
  mjData& data = dynamics.data();
  VectorXd::Map(data.qvel, model_.nv) = point.velocity;
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    data.ctrl[actuators[i]] = point.inputs[static_cast<Index>(i)];
  }
  VectorXd inertial(model_.nv);
  MechanicalModel result;
  result.K = -Differentiate(
      [&]() -> VectorXd {
        const VectorXd force = dynamics.Force();
        mj_mulM(bare_.get(), &data, inertial.data(), point.acceleration.data());
        return force - inertial;
      },
      data.qpos, dynamics.size());
  result.D =
      -Differentiate([&] { return dynamics.Force(); }, data.qvel, dynamics.size());
  result.K += JointStiffness(model_).asDiagonal();
  result.D += JointDamping(model_);
  for (int joint = 0; joint < model_.njnt; ++joint) {
    result.coordinates.push_back(ElementName(model_, mjOBJ_JOINT, joint));
  }
  result.inputs = ChannelsOf(channels_.actuators);
  result.outputs = ChannelsOf(channels_.sensors);
  result.M = SmoothDynamics(*bare_, point.position).Mass();
  result.Gamma = InputMatrix(*unlimited_, channels_, point.position);
  result.b = OutputMatrix(*bare_, channels_, point.position);
  return result;
}

}  // namespace mjdiag
