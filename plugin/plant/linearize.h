#pragma once
// From a MuJoCo model to linear equations of motion: of all its coordinates as if no
// constraint tied them, and under the constraints that hold (Linearization).

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/plant/constraint_rows.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/operating_point.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// b of y = b^T q about `position`, nv x ny, in tangent coordinates. 0 of sensors that do
/// not read a position.
Eigen::MatrixXd OutputMatrix(const mjModel& model, const Channels& channels,
                             const Eigen::VectorXd& position);

/// Of sensors that read velocities, their derivatives by those, nv x ny; 0 of others.
Eigen::MatrixXd VelocityOutputMatrix(const mjModel& model, const Channels& channels,
                                     const Eigen::VectorXd& position);

/// M, D, K (springs and gravity), Gamma and b of the channels about the configuration
/// `rest`, in tangent coordinates (tangent_coordinates.h), as if no constraint acted.
/// Static friction is left out, as in [AB383], section 2.2.3. The input of an actuator
/// with dynamics of its own is its activation.
MechanicalModel Linearize(const mjModel& model, const Channels& channels,
                          const Eigen::VectorXd& rest);

/// For methods that know machines of slides and hinges, driven and read without delay, only:
/// InputError names the joint, actuator or sensor that is something else.
void RequireScalarJoints(const mjModel& model, const Channels& channels);

/// Where a machine is, at one moment of a motion.
struct MotionPoint {
  Eigen::VectorXd position;      ///< nq
  Eigen::VectorXd velocity;      ///< nv
  Eigen::VectorXd acceleration;  ///< nv
  Eigen::VectorXd inputs;        ///< of the actuator channels, nu
};

/// M, D, K, Gamma and b of deviations from a motion: with the smooth force f of springs,
/// dampers, motors, gravity and inertia,
///
///   K = -d/dq (f(q, q', u) - M(q) q''),     D = -d/dq' f(q, q', u)
///
/// At rest without inputs that is what Linearize gives.
class MotionLinearization {
 public:
  /// Both have to outlive it.
  MotionLinearization(const mjModel& model, const Channels& channels);
  /// May be called by several threads.
  MechanicalModel At(const MotionPoint& point) const;
  MechanicalModel About(const OperatingPoint& point) const;

 private:
  const mjModel& model_;
  const Channels& channels_;
  ModelPtr bare_;
  ModelPtr unlimited_;
};

/// A machine about an operating point, under the constraints that hold there.
///
/// Equalities, limits and contacts that press are taken as rigid: with q = T q_i of the
/// motions that they allow (constraint_rows.h), their forces lambda and f the smooth ones,
///
///   T^T M T q_i'' + T^T D T q_i' + T^T (K - d/dq (J^T lambda)) T q_i = T^T Gamma u
///
/// A contact with friction holds across, too. How soft MuJoCo's constraints are, what a
/// contact creeps, and the dynamics of actuators, are in Transition alone (transition.h).
struct Linearization {
  MechanicalModel model;  ///< in the independent coordinates
  std::vector<std::string> dependent;
  Eigen::MatrixXd ties;  ///< dependent x independent: how they follow small motions
  bool stable = false;   ///< no motion grows
  /// What one has to know about the matrices: actuators with dynamics, sensors that read
  /// no position.
  std::vector<std::string> notes;
};
Linearization LinearizeAbout(const mjModel& model, const Channels& channels,
                             const OperatingPoint& point);

}  // namespace mjdiag
