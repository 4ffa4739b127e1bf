#pragma once
// Which joints of a model are driven and which are merely compliant.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <vector>

#include "mjdiag/render/amplification.h"

namespace mjdiag {

/// Slide and hinge joints in the model's order. A joint without a spring is driven. Of
/// the sprung ones an actuator drives the joint that takes most of its static stroke,
/// the largest r_j^2 / k_j (r_j moment arm, k_j stiffness, at qpos0); joints that take
/// most of no actuator's stroke are compliant.
std::vector<DrawnJoint> DrawnJoints(const mjModel& model);

/// Puts the positions [m or rad] of DrawnJoints, in their order, into data.qpos.
void SetPositions(const mjModel& model, const Eigen::VectorXd& positions, mjData& data);

}  // namespace mjdiag
