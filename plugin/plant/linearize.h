#pragma once
// From a MuJoCo model to the linear equations of motion about its static equilibrium.

#include <mujoco/mujoco.h>

#include "mjdiag/diagnosis/model/mechanical_model.h"
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

}  // namespace mjdiag
