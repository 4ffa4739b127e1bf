#pragma once
// The motion of a machine as the filter with latent forces found it, for what is computed
// along it.

#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// Positions in tangent coordinates from qpos0, velocities, and the mean accelerations of
/// every tick, with the latent forces. The input of an actuator that is off is that of an
/// open circuit. Outputs are what the filter expected of each reading before it was taken:
/// what a reading makes of itself would explain any.
ObservedMotion MotionAlong(const Machine& machine, const MeasuredRun& run,
                           const FilterPath& path);

}  // namespace mjdiag
