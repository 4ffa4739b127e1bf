#pragma once
// Setpoint trajectories: sequences of rest-to-rest moves with bounded velocity,
// acceleration, jerk and snap (fourth-order setpoints), one or several axes at a time.

#include <map>
#include <string>
#include <vector>

#include "mjdiag/controllers/reference.h"
#include "mjdiag/controllers/setpoint.h"

namespace mjdiag {

/// At time `at` [s], taken to the nearest control tick, every axis in `by` starts a
/// move of that distance [m or rad].
struct Move {
  double at = 0.0;
  std::map<std::string, double> by;
};

/// A named trajectory of a setup: the moves repeat every `period` (0: never) until
/// `duration` [s].
struct Trajectory {
  std::string name;
  double duration = 0.0;
  double period = 0.0;
  std::vector<Move> moves;
  std::map<std::string, MoveLimits> limits;  ///< per axis
};

/// Samples the trajectory on the control grid, t = 0 .. duration - sample_time, for the
/// axes in the given order; every axis starts at 0. Snap is the one held from a sample
/// to the next. InputError names the move: an axis that is not among `axes` or without
/// limits, limits not positive, a start outside the period, or a start before the
/// previous move of its axis has ended.
Reference SampleTrajectory(const Trajectory& trajectory,
                           const std::vector<std::string>& axes, double sample_time);

}  // namespace mjdiag
