#pragma once
// MuJoCo's tangent coordinates, in which all joints are alike: nv numbers that say how
// far a machine is from a configuration.
//
//   slide, hinge  the coordinate of the joint
//   ball          a rotation vector in the frame of the body
//   free          a displacement in the world frame and a rotation vector in the frame of
//                 the body

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mjdiag {

/// Names of the nv coordinates: "<joint>" of a slide or hinge, "<joint>.rx" .. ".rz" of a
/// ball, "<joint>.x" .. ".z" and "<joint>.rx" .. ".rz" of a free joint.
std::vector<std::string> CoordinateNames(const mjModel& model);

/// Whether a coordinate is a length, of a slide or a free joint; else it is an angle.
bool IsLength(const mjModel& model, int dof);

/// The configuration (nq) that is `displacement` (nv) away from `qpos`.
Eigen::VectorXd Displaced(const mjModel& model, const Eigen::VectorXd& qpos,
                          const Eigen::VectorXd& displacement);

/// How far `to` is from `from`, nv.
Eigen::VectorXd Displacement(const mjModel& model, const Eigen::VectorXd& from,
                             const Eigen::VectorXd& to);

}  // namespace mjdiag
