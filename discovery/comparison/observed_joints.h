#pragma once
// The joints of a machine along a measured record, as a filter has them that follows the
// readings whatever the plant lacks (FollowingNoise of noise_fit.h): what a clip of a
// measurement shows. Joints that no sensor sees move as the plant moves them.

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// The record with a channel "joint.<name>" for every slide and hinge that it has none of.
/// InputError where a sensor or an actuator of the setup is missing in it.
Record WithObservedJoints(const Machine& machine, const Record& measured);

}  // namespace mjdiag
