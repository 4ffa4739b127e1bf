#include "mjdiag/plugin/plant/motor_force.h"

#include <algorithm>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

double Clamped(double value, int motor, const mjtByte* limited, const mjtNum* ranges) {
  const mjtNum* range = RowOf(ranges, 2, motor);
  return limited[motor] == 0 ? value : std::clamp(value, range[0], range[1]);
}

bool HasBias(const mjModel& model, int motor) {
  return model.actuator_biastype[motor] == mjBIAS_AFFINE;
}

double Bias(const mjModel& model, const mjData& data, int motor) {
  if (!HasBias(model, motor)) return 0.0;
  const mjtNum* bias = RowOf(model.actuator_biasprm, mjNBIAS, motor);
  return bias[0] + bias[1] * data.actuator_length[motor] +
         bias[2] * data.actuator_velocity[motor];
}

}  // namespace

double MotorGain(const mjModel& model, int motor) noexcept {
  return RowOf(model.actuator_gainprm, mjNGAIN, motor)[0];
}

double MotorForce(const mjModel& model, const mjData& data, int motor) noexcept {
  const double command = Clamped(data.ctrl[motor], motor, model.actuator_ctrllimited,
                                 model.actuator_ctrlrange);
  return Clamped(MotorGain(model, motor) * command + Bias(model, data, motor), motor,
                 model.actuator_forcelimited, model.actuator_forcerange);
}

double GearOf(const mjModel& model, int motor) noexcept {
  return mju_norm(RowOf(model.actuator_gear, 6, motor), 6);
}

double OpenCircuitCommand(const mjModel& model, const mjData& data,
                          int motor) noexcept {
  return -Bias(model, data, motor) / MotorGain(model, motor);
}

void CheckOpenCircuit(const mjModel& model, int motor) {
  const bool limited = model.actuator_ctrllimited[motor] != 0 && HasBias(model, motor);
  if (model.actuator_gaintype[motor] == mjGAIN_FIXED &&
      MotorGain(model, motor) != 0.0 &&
      model.actuator_biastype[motor] != mjBIAS_MUSCLE && !limited) {
    return;
  }
  throw InputError("actuator " + ElementName(model, mjOBJ_ACTUATOR, motor),
                   "cannot be switched off",
                   "a fixed gain, and no ctrlrange beside an affine bias (enabled_by)");
}

MotorBias MotorBiasOf(const mjModel& model, const mjData& data,
                      std::span<const int> off) {
  MotorBias sum{Eigen::MatrixXd::Zero(model.nv, model.nv),
                Eigen::MatrixXd::Zero(model.nv, model.nv)};
  for (int motor = 0; motor < model.nu; ++motor) {
    if (!HasBias(model, motor) || std::ranges::count(off, motor) > 0) continue;
    const mjtNum* bias = RowOf(model.actuator_biasprm, mjNBIAS, motor);
    const auto arm =
        Eigen::VectorXd::Map(RowOf(data.actuator_moment, model.nv, motor), model.nv);
    sum.stiffness -= bias[1] * arm * arm.transpose();
    sum.damping -= bias[2] * arm * arm.transpose();
  }
  return sum;
}

MotorBias MotorBiasAtQpos0(const mjModel& model) {
  const DataPtr data = MakeData(model);
  mj_fwdPosition(&model, data.get());
  return MotorBiasOf(model, *data, {});
}

}  // namespace mjdiag
