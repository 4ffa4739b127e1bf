#pragma once
// Ideal dry friction over one step, of any number of joints that push each other.

#include <Eigen/Core>

namespace mjdiag::test {

/// Forces f with |f_i| <= bound_i that would end all sliding within a step, as far as they
/// can: with the velocities w that the step would end with without them and A the velocity
/// that a unit of force gives over the step,
///
///   w + A f = v,   v_i = 0 where |f_i| < bound_i, else f_i = -bound_i sign(v_i)
///
/// @param A  symmetric, positive definite
Eigen::VectorXd DryFriction(const Eigen::MatrixXd& A, const Eigen::VectorXd& w,
                            const Eigen::VectorXd& bound);

}  // namespace mjdiag::test
