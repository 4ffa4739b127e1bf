#pragma once
// Whether a force without a name is one that works. Friction only takes, so a learned curve
// that delivers energy to its joint, beside the damper and the dry friction that the plant
// has there, is no friction, whatever it looks like.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

namespace mjdiag {

/// Of a curve over the joint's own velocity, or times that or its direction: whether the
/// power F v that it delivers exceeds damping v^2 + friction |v| at any knot, by more than
/// the curve is uncertain. Never of a curve over anything else: over a position it may be a
/// spring, and over time or a command nobody takes it for friction.
/// @param values     of force_curve
/// @param low, high  intervals of its knots
/// @param joint      that it acts at (nv)
bool DrivesItsJoint(const mjModel& plant, Eigen::Index joint,
                    const Eigen::VectorXd& values, const Eigen::VectorXd& low,
                    const Eigen::VectorXd& high);

}  // namespace mjdiag
