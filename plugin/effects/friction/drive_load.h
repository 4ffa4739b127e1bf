#pragma once
// What a drive transmits to its joint: the force of the motors on the joint, and the rest
// of the force on it (gravity, springs, dampers, velocity products, other effects; without
// dry friction). The two work against each other where the drive carries a load.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

#include "mjdiag/plugin/effects/candidate_regressor.h"

namespace mjdiag {

struct DriveLoad {
  double motor = 0.0;  ///< [N, N m]
  double rest = 0.0;
};

/// Of all motors on the joint, in a step when its commands are known [N, N m].
double MotorForceOn(const mjModel& model, const mjData& data, int dof) noexcept;

/// In a step, when all its commands and forces are known.
DriveLoad DriveLoadOf(const mjModel& model, const mjData& data, int dof) noexcept;

/// Along a motion. The rest is what accelerates the joint beside its motors, to first
/// order without friction.
struct ObservedLoad {
  explicit ObservedLoad(const SiteMotion& at);

  Eigen::VectorXd motor;
  Eigen::VectorXd rest;
};

}  // namespace mjdiag
