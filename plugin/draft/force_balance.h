#pragma once
// How well a log agrees with its plant, if its columns are what they are taken for: the
// forces that the motion needs beside those that the controls give,
//
//   M(q) qdd + c(q, qd) - passive - constraints   and   actuators(u, q, qd).
//
// Positions and controls go through the same zero-phase low-pass, behind which positions are
// differentiated. What a plant mostly lacks, an offset, viscous and dry friction, is fitted
// and taken out of every term. The imbalance is what is left of the balance over the terms
// that ought to cancel, as root mean squares, all joints together:
//
//   0  they cancel      1  they have nothing to do with each other, or the wrong sign
//
// Degrees taken for radians, amperes for newtons or a column of another joint leave 1. The
// low-pass is the one of several that leaves least: noise hides a motion above it.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <optional>

namespace mjdiag {

struct LoggedMotion {
  double sample_time = 0.0;   ///< [s]
  Eigen::MatrixXd positions;  ///< of all joints, slides and hinges, in SI, nq x samples
  Eigen::MatrixXd controls;   ///< of all actuators, nu x samples
  Eigen::MatrixXd forces;     ///< besides those of actuators, nv x samples
};

/// Whether the balance can be made up: slides and hinges alone, actuators without
/// activations.
bool HasForceBalance(const mjModel& model);

/// @param lag  samples by which controls and forces act later
/// None of a log that is too short, or does not move.
std::optional<double> ForceImbalance(const mjModel& model, const LoggedMotion& motion,
                                     int lag = 0);

}  // namespace mjdiag
