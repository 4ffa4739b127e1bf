#pragma once
// What motion tells of masses and of where they are. A joint feels of everything that it
// carries its first moment about the axis. Of what hangs on a further joint it feels in all
// postures alike only what stays where it is while that joint turns: its mass, on that
// joint's axis. Gathered there, from the tip down, masses and centres of mass become one
// vector for every hinge,
//
//   S = sum over bodies m (c - anchor),   without its part along the axis  [kg m],
//
// which gravity and inertia show as a whole: numbers of single bodies are told by no motion
// that leaves S as it is. (These are the regrouped first moments of the base parameters of
// M. Gautier, W. Khalil, "Direct Calculation of Minimum Set of Inertial Parameters of Serial
// Robots", IEEE Trans. Robotics and Automation 6, 1990, for any tree of hinges and slides.)

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjdiag {

/// A component of S along an axis of the frame of the body that the hinge turns.
struct MassMoment {
  std::string joint;
  std::string axis;  ///< "x", "y" or "z"
  double value = 0.0;
};

/// Two of every hinge, in the order of the joints.
std::vector<MassMoment> MassMoments(const mjModel& plant);

}  // namespace mjdiag
