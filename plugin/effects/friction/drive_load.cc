#include "mjdiag/plugin/effects/friction/drive_load.h"

#include "mjdiag/plugin/plant/motor_force.h"

namespace mjdiag {

DriveLoad DriveLoadOf(const mjModel& model, const mjData& data, int dof) noexcept {
  DriveLoad load;
  load.rest = data.qfrc_passive[dof] + data.qfrc_applied[dof] - data.qfrc_bias[dof];
  for (int motor = 0; motor < model.nu; ++motor) {
    const double arm = data.actuator_moment[motor * model.nv + dof];
    if (arm != 0.0) load.motor += arm * MotorForce(model, data, motor);
  }
  return load;
}

ObservedLoad::ObservedLoad(const SiteMotion& at)
    : motor(at.motor()),
      rest(at.motion.acceleration.transpose() *
               at.model.M.row(at.site.joint).transpose() -
           motor) {}

}  // namespace mjdiag
