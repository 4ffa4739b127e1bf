#pragma once
// Where a plant comes to rest.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

namespace mjdiag {

/// A configuration, and whether the plant stays in it without input.
struct RestPose {
  Eigen::VectorXd qpos;  ///< nq
  bool rests = false;    ///< all forces balance there
  /// Generalised force that would hold it, nv [N, N m]; 0 where it rests.
  Eigen::VectorXd holding_force;
  bool stable = false;  ///< it comes back after a small push, or stays where pushed to
};

/// Where a plant settles from the configuration that its MJCF draws (qpos0), controls and
/// activations 0, static friction left out. It goes downhill in steps of the implicit
/// Euler rule of overdamped motion,
///
///   (K + mu W) dq = f(q),   W = diag M,   K = -df/dq,
///
/// f the forces of a plant that does not accelerate, those of equalities, limits and
/// contacts too (plant_forces.h), mu such that no step is longer than what it has been
/// right about, and 0 at the end, which is Newton's method. Coordinates that nothing
/// pulls at stay where they are. A plant that is drawn balanced is pushed off.
///
/// What does not settle so moves as MuJoCo does, in a thick fluid, until it is still, and
/// goes on from there: bodies that fall on a floor in many ways. What creeps then by less
/// than 2 mm/s or 2 mrad/s (times the extent of the plant) is held by the friction of its
/// contacts, and rests.
///
/// A plant that controllers hold stays where it is drawn balanced.
///
/// Where nothing rests (free fall, a joint that is driven on and on) it is the
/// configuration as drawn, with what would hold it. The search ends after 400 steps
/// downhill, 8000 in the fluid and 400 more.
/// @param held  by controllers, once it runs
RestPose FindRest(const mjModel& model, bool held = false);

/// What a plant does in a configuration without input.
RestPose PoseAt(const mjModel& model, const Eigen::VectorXd& qpos);

}  // namespace mjdiag
