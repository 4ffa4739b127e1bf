#pragma once
// What a time step lets a law of bristles be: springs and dampers by an explicit force,
// which are stable on a mass m with the step h while
//   stiffness h^2 / m + 2 damping h / m < 4.
// Stiffer ones act as stiff as that allows, which is dry friction that creeps a little.

#include <mujoco/mujoco.h>

#include <limits>

namespace mjdiag {

/// With a mass of half of what the joint moves at qpos0, for it may move less elsewhere:
/// together they come to 1.5 on what it moves there.
struct BristleLimits {
  BristleLimits(const mjModel& model, int dof) {
    const double h = model.opt.timestep;
    const double mobility = model.dof_invweight0[dof];
    if (!(mobility > 0.0)) return;
    stiffness = 0.5 / (mobility * h * h);
    damping = 0.5 / (mobility * h);
  }

  double stiffness = std::numeric_limits<double>::infinity();  ///< [N/m, N m]
  double damping = std::numeric_limits<double>::infinity();    ///< [N s/m, N m s]
};

}  // namespace mjdiag
