#pragma once
// The analytic linear model of a machine in a file: bodies with masses and joints,
// force pairs and scales, all in the reference configuration and in world coordinates.
//
//   schema = "mjdiag.linear_chain/1"
//   gravity = 9.81                       # m/s^2, downwards along z; default 9.81
//   [[bodies]]                           # parents first
//   name = "stage"
//   parent = "base"                      # default: the world
//   mass = 2.0                           # kg
//   centre = [0.0, 0.0, 0.1]             # centre of mass, m
//   inertia = [0.01, 0.01, 0.02]         # about the centre, along world axes, kg m^2
//   [[bodies.joints]]                    # from the parent outwards
//   name = "X"
//   type = "slide"                       # or "hinge"
//   axis = [1, 0, 0]                     # unit vector
//   point = [0.0, 0.0, 0.0]              # on the axis of a hinge, m
//   stiffness = 0.0                      # N/m or N m/rad; default 0
//   damping = 10.0                       # N s/m or N m s/rad; default 0
//   [[actuators]]                        # and [[sensors]], alike
//   name = "u_x"
//   body = "stage"                       # +1 on body, -1 on base
//   base = "base"                        # default: the world
//   type = "linear"                      # or "rotational"
//   axis = [1, 0, 0]
//   point = [0.0, 0.05, 0.1]             # m; of a linear one

#include <filesystem>

#include "mjdiag/diagnosis/model/linear_chain.h"

namespace mjdiag {

/// InputError says file, line and key: malformed TOML, missing or unknown key, wrong
/// type, an axis that is not a unit vector, a body that is not there.
LinearChain ReadLinearChain(const std::filesystem::path& file);

}  // namespace mjdiag
