#pragma once
// The force of a motor, as MuJoCo computes it from the command of a step,
//   f = gain u + b0 + b1 l + b2 l'
// with the length l of its transmission; commands and forces are clamped to their
// ranges, the gear makes a force on the joint of it. A DC motor driven by a voltage is
//   gain = 1 / R,  b2 = -1 / R,  gear = kt:  f is the current, kt l' the back EMF.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <span>

namespace mjdiag {

/// Before the gear, of the command in data.ctrl. After positions and velocities.
double MotorForce(const mjModel& model, const mjData& data, int motor) noexcept;

/// Of its force by its command.
double MotorGain(const mjModel& model, int motor) noexcept;
/// Force or torque of a unit of its force: length of the six numbers of the gear.
double GearOf(const mjModel& model, int motor) noexcept;

/// The command at which the motor gives no force: what an open circuit shows at its
/// ends, which is the back EMF of a DC motor.
double OpenCircuitCommand(const mjModel& model, const mjData& data, int motor) noexcept;
/// InputError if no command makes its force 0 at all times.
void CheckOpenCircuit(const mjModel& model, int motor);

/// What of the stiffness and of the damping of the joints is the motors' own: gone from
/// those that are an open circuit. nv x nv.
struct MotorBias {
  Eigen::MatrixXd stiffness;
  Eigen::MatrixXd damping;
};
/// After positions. @param off  motors that are left out
MotorBias MotorBiasOf(const mjModel& model, const mjData& data,
                      std::span<const int> off);
/// Of all motors at qpos0: their arms on the joints do not change with them, or by little.
MotorBias MotorBiasAtQpos0(const mjModel& model);

}  // namespace mjdiag
