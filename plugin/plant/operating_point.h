#pragma once
// The state of a plant about which it is linearised, and what keeps it there.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

#include "mjdiag/plugin/plant/rest.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

struct OperatingPoint {
  Eigen::VectorXd qpos;          ///< nq
  Eigen::VectorXd velocity;      ///< nv, in tangent coordinates, as all below
  Eigen::VectorXd acceleration;  ///< nv
  Eigen::VectorXd activation;    ///< na
  Eigen::VectorXd controls;      ///< of all actuators of the plant, nu
  /// What is applied to the plant besides, so that it accelerates like that, nv [N, N m].
  Eigen::VectorXd applied_force;
  /// What holds it against its own forces, of actuators and applied, nv.
  Eigen::VectorXd holding_force;
  bool rests = false;  ///< stays there without input
};

/// A configuration, without motion. Where the plant does not rest in it, it is held: by the
/// actuator channels if they can, all others 0, and not against their limits; else by
/// forces on the joints, actuators 0. What equalities, limits and contacts that press can
/// carry, they carry: forces are those on independent coordinates (MakeIndependent).
OperatingPoint HeldAt(const mjModel& model, const Channels& channels,
                      const RestPose& pose);

/// A moment of a motion, with the inputs of that moment; what is missing in the forces
/// is applied, on independent coordinates. Activations are those that the inputs lead to.
/// @param inputs  of the actuator channels
OperatingPoint MovingAt(const mjModel& model, const Channels& channels,
                        const Eigen::VectorXd& qpos, const Eigen::VectorXd& velocity,
                        const Eigen::VectorXd& acceleration,
                        const Eigen::VectorXd& inputs);

/// Puts the state and the inputs into data.
void Set(const mjModel& model, const OperatingPoint& point, mjData& data);

/// The signal that an actuator's force is proportional to: its activation if it has one,
/// else its control.
mjtNum& DriveOf(const mjModel& model, mjData& data, int actuator);
/// Place of the activation of an actuator, -1: it has none.
int ActivationOf(const mjModel& model, int actuator);

}  // namespace mjdiag
