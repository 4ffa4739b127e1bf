#pragma once
// The forces of a plant that does not accelerate, and their derivatives.
//
// Smooth are those of springs, dampers, actuators, gravity and inertia. Those of
// constraints (equalities, limits, contacts) are a function of the configuration, too,
// where nothing accelerates: MuJoCo's constraints are springs and dampers,
//   f_c = J^T s(-a_ref),   a_ref = -k r - b v
// with the residual r of the constraint and the force s that belongs to an acceleration
// of it (mj_constraintUpdate). Static friction, of joints and contacts, is 0 there.
//
// The control callback is not called: it would act on the controls and is shared with
// simulations in other threads.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <functional>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

class PlantForces {
 public:
  /// At rest at `qpos`, controls and activations 0. @param model  has to outlive it
  PlantForces(const mjModel& model, const Eigen::VectorXd& qpos);

  mjData& data() { return *data_; }
  const mjModel& model() const { return model_; }
  int size() const { return static_cast<int>(model_.nv); }
  Eigen::VectorXd qpos() const;
  void MoveTo(const Eigen::VectorXd& qpos);

  /// Evaluates positions, velocities, controls and activations as they are in the data,
  /// sensors of positions and velocities too.
  void Update();
  /// Generalised smooth force that accelerates the machine, nv.
  Eigen::VectorXd Smooth();
  /// With that of the constraints. What they do stays in efc_force of the data.
  Eigen::VectorXd Total();
  /// That of the constraints alone, after Update.
  Eigen::VectorXd OfConstraints();
  /// nv x nv.
  Eigen::MatrixXd Mass();

 private:
  const mjModel& model_;
  DataPtr data_;
};

/// d function / d q in tangent coordinates, about the configuration of `forces`, which
/// `function` evaluates: the central difference of sixth order. The step balances
/// truncation, step^6 / 140, against rounding, eps / step, for functions that change over
/// lengths of order one, as those of a kinematic chain do.
Eigen::MatrixXd ByPosition(PlantForces& forces,
                           const std::function<Eigen::VectorXd()>& function);
/// The same with the simple central difference, for what has kinks or need not be exact.
Eigen::MatrixXd ByPosition(PlantForces& forces,
                           const std::function<Eigen::VectorXd()>& function,
                           double step);
/// d function / d velocity.
Eigen::MatrixXd ByVelocity(PlantForces& forces,
                           const std::function<Eigen::VectorXd()>& function);

/// Stiffness of the springs of slides and hinges, 0 of others, nv.
Eigen::VectorXd ScalarSprings(const mjModel& model);
/// A copy of a model in which slides and hinges have no springs, no joint has a damper and
/// no constraint acts. What springs and dampers contribute is known exactly, and 1e8 N/m
/// of mount stiffness would bury the gravity stiffness of 1e-2 N m/rad in rounding.
ModelPtr WithoutJointSprings(const mjModel& model);

}  // namespace mjdiag
