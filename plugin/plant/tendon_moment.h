#pragma once
// How fast tendons grow longer by their joints.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

namespace mjdiag {

/// d length / d q along the degrees of freedom, nv; where mj_tendon has been called.
Eigen::VectorXd TendonMoment(const mjModel& model, const mjData& data, int tendon);
/// Of all tendons in a configuration, nv x tendons.
Eigen::MatrixXd TendonMoments(const mjModel& model, const mjtNum* qpos);

}  // namespace mjdiag
