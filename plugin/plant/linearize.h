#pragma once
// From a MuJoCo model to the linear equations of motion about its static equilibrium.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// Joint positions at which the machine rests without input (frictionloss off): damped
/// Newton on qfrc_passive - qfrc_bias = 0, from qpos0. NumericalError if it does not
/// converge.
Eigen::VectorXd StaticEquilibrium(const mjModel& model);

/// b of y = b^T q about `position`, nq x ny. InputError if a sensor of the setup does
/// not read a position.
Eigen::MatrixXd OutputMatrix(const mjModel& model, const Channels& channels,
                             const Eigen::VectorXd& position);

/// M, D, K (springs and gravity), Gamma and b of the channels at the static equilibrium
/// `rest`. Static friction is left out, as in [AB383], section 2.2.3. Requires slide
/// and hinge joints only (InputError names others).
MechanicalModel Linearize(const mjModel& model, const Channels& channels,
                          const Eigen::VectorXd& rest);

/// Where a machine is, at one moment of a motion.
struct MotionPoint {
  Eigen::VectorXd position;      ///< nq
  Eigen::VectorXd velocity;      ///< nq
  Eigen::VectorXd acceleration;  ///< nq
  Eigen::VectorXd inputs;        ///< of the actuator channels, nu
};

/// M, D, K, Gamma and b of deviations from a motion: with the smooth force f of springs,
/// dampers, motors, gravity and inertia,
///
///   K = -d/dq (f(q, q', u) - M(q) q''),     D = -d/dq' f(q, q', u)
///
/// At rest without inputs that is what Linearize gives. InputError as there.
class MotionLinearization {
 public:
  /// Both have to outlive it.
  MotionLinearization(const mjModel& model, const Channels& channels);
  /// May be called by several threads.
  MechanicalModel At(const MotionPoint& point) const;

 private:
  const mjModel& model_;
  const Channels& channels_;
  ModelPtr bare_;
  ModelPtr unlimited_;
};

}  // namespace mjdiag
