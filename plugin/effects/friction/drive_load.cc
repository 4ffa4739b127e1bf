#include "mjdiag/plugin/effects/friction/drive_load.h"

#include "mjdiag/plugin/plant/motor_force.h"

namespace mjdiag {

double MotorForceOn(const mjModel& model, const mjData& data, int dof) noexcept {
  double force = 0.0;
  for (int motor = 0; motor < model.nu; ++motor) {
    const double arm = data.actuator_moment[motor * model.nv + dof];
    if (arm != 0.0) force += arm * MotorForce(model, data, motor);
  }
  return force;
}

DriveLoad DriveLoadOf(const mjModel& model, const mjData& data, int dof) noexcept {
  const double rest =
      data.qfrc_passive[dof] + data.qfrc_applied[dof] - data.qfrc_bias[dof];
  return {.motor = MotorForceOn(model, data, dof), .rest = rest};
}

ObservedLoad::ObservedLoad(const SiteMotion& at)
    : motor(at.motor()),
      rest(at.motion.acceleration.transpose() *
               at.model.M.row(at.site.joint).transpose() -
           motor) {}

}  // namespace mjdiag
