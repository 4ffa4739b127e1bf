#pragma once
// Setpoint trajectories: sequences of rest-to-rest moves with bounded velocity,
// acceleration, jerk and snap (fourth-order setpoints), one or several axes at a time, and
// on top of them tones,
//
//   r(t) = moves(t) + w(t) sum_k a_k sin(2 pi f_k t + p_k),
//
// where w rises from 0 to 1 over the ramp, falls to 0 over the last of it, and has four
// derivatives that are 0 at both ends: whatever the tones are, they begin and end at rest.

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

/// A sine on an axis.
struct ReferenceTone {
  std::string axis;
  double frequency = 0.0;  ///< f [Hz]
  double amplitude = 0.0;  ///< a [m or rad]
  double phase = 0.0;      ///< p [rad], at the start of the trajectory
};

/// A named trajectory of a setup: the moves repeat every `period` (0: never) until
/// `duration` [s]; tones last from the start to then.
struct Trajectory {
  std::string name;
  double duration = 0.0;
  double period = 0.0;
  std::vector<Move> moves;
  std::map<std::string, MoveLimits> limits;  ///< per axis, of the moves
  std::vector<ReferenceTone> tones;
  double ramp = 0.0;  ///< in which tones rise and fall [s]
};

/// Samples the trajectory on the control grid, t = 0 .. duration - sample_time, for the
/// axes in the given order; every axis starts at 0. Snap is the one held from a sample
/// to the next. InputError names the move: an axis that is not among `axes` or without
/// limits, limits not positive, a start outside the period, or a start before the
/// previous move of its axis has ended; or a tone that the control rate cannot follow, or
/// without a ramp.
Reference SampleTrajectory(const Trajectory& trajectory,
                           const std::vector<std::string>& axes, double sample_time);

}  // namespace mjdiag
