#pragma once
// `mjdiag excite --json`: a motion and what it tells, for other programs.

#include <nlohmann/json.hpp>

#include "mjdiag/studies/excitation/joint_motion_design.h"
#include "mjdiag/studies/excitation/motion_design.h"

namespace mjdiag {

/// schema "mjdiag.excitation/1"; setup, trajectory [its name], duration [s], gain,
/// stopped; moves {of: trajectory or null, times}; tones [{axis, frequency [Hz],
/// amplitude, phase [rad]}]; unknowns [{name, wanted, sd_before, sd_after}]; limits and
/// peaks {axis: {lowest, highest, velocity, acceleration, jerk, snap, force}}. All in SI
/// units.
nlohmann::json ToJson(const Machine& machine, const MotionDesign& design);

/// schema "mjdiag.joint_excitation/1"; setup, duration [s], highest_frequency [Hz],
/// condition_before, condition_after, bandwidth [Hz], stopped; numbers [{name, unit,
/// sd_before, sd_after}], untold [how many others]; joints {joint: {noise, limits, peaks}}.
nlohmann::json ToJson(const Machine& machine, const JointMotionDesign& design);

/// {lowest, highest, velocity, ...}
nlohmann::json ToJson(const AxisLimits& limits);

}  // namespace mjdiag
