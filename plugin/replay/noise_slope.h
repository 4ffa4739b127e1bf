#pragma once
// How -2 ln L of a filter along a path (linear_pass.h) changes with the logarithms of its
// noises, all at once and exactly: the recursion of the filter backwards. With z, P what is
// known before a reading, u = P c, S = c u + r^2, e = y - c z,
//
//   z+ = z + u e / S,   P+ = P - u u' / S,   cost = ln S + e^2 / S,
//
// the adjoints Z, Q of z+, P+ (of -2 ln L by them) give those before it
//
//   de = 2 e / S + Z u / S,   du = (e Z - 2 Q u) / S + dS c,
//   dS = 1 / S - e^2 / S^2 - (e Z u - u' Q u) / S^2,
//   Z - de c,   Q + (du c' + c du') / 2,
//
// and dS is the slope by r^2. Beyond Huber's corner c0 it is V = |e| sqrt(S) / c0 that stands
// for S in z+ and P+, and the cost is ln S + c0 (2 |e| / sqrt(S) - c0). Through a tick, z = F z,
// P = F P F' + N: F' Z and F' Q F; Q is the slope by N. Takes as long as three passes, however
// many noises there are. Where so many readings are beyond the corner that a machine that falls
// is not held by first order, V is taken as it is.

#include <Eigen/Core>

#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

struct NoiseSlope {
  double deviance = 0.0;
  /// By ln of: size, memory, white (nf each), reading (ny), clock, clock_memory.
  Eigen::VectorXd slope;
  /// The same of parts of 20 ticks, one after the other, whose sum it is: how it scatters
  /// tells how -2 ln L bends.
  Eigen::MatrixXd parts;
};

/// @param count  as LinearPass::Over
NoiseSlope SlopeAlong(const FilterPath& path, const FilterNoise& noise,
                      Eigen::Index first, Eigen::Index count);

}  // namespace mjdiag
