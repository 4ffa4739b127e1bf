#pragma once
// The joints of a machine along a measured record, as the observer has them: what a
// clip of a measurement shows. The plant follows the encoders within the bandwidth of
// the observer; joints that no encoder sees move as the plant moves them.

#include <mujoco/mujoco.h>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// The record with a channel "joint.<name>" for every joint that it has none of.
/// InputError where a sensor or an actuator of the setup is missing in it.
Record WithObservedJoints(const Machine& machine, const Record& measured);

}  // namespace mjdiag
