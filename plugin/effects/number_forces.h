#pragma once
// What numbers of a plant do along a motion: the generalised force by which the plant
// acts otherwise if one of them is larger, at the same positions, velocities and
// accelerations,
//
//   F = - d/d(log p) [ M(q) q'' + c(q, q') + g(q) - passive(q, q') - motors(q, q', u) ]
//
// Masses and inertias enter linearly, so that inverse dynamics with twice the number less
// that with the number itself is the derivative; springs, dampers, rotors and dry friction
// of joints in closed form, that of tendons along their moments; all else by a small
// difference about the plant. One pass over the samples for each.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <span>

#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/plant/model_parameter.h"

namespace mjdiag {

/// Speeds below which joints stand still, nv: what the noise of readings may seem to be.
/// @param reading_noise  of every sensor
Eigen::VectorXd StillSpeeds(const mjModel& plant, const Eigen::VectorXd& reading_noise,
                            double sample_time);

/// F, samples x nv [N, N m].
/// @param plant      with the number as it is
/// @param actuators  ids of those that the inputs drive; -1: none
/// @param still      speeds of the joints below which dry friction holds them, nv
Eigen::MatrixXd NumberForce(const mjModel& plant, std::span<const int> actuators,
                            const ModelParameter& number, const ObservedMotion& motion,
                            const Eigen::VectorXd& still);

/// The same of all inputs and dampers a second later: - Gamma du/dt, of inputs that are
/// held, and D q''.
/// @param Gamma  nv x inputs
Eigen::MatrixXd DelayForce(const mjModel& plant, const Eigen::MatrixXd& Gamma,
                           const ObservedMotion& motion);

}  // namespace mjdiag
