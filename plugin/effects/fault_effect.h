#pragma once
// Fault parameters as effects: a plant declares them itself (fault.h), and what a
// discovery asks of an effect it asks of them as well. Their one parameter is their
// value; 1: healthy.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/fault.h"

namespace mjdiag {

EffectPtr FaultEffect(FaultParameter declared);

/// All that the plant declares, in the order of the file, at their healthy value. The
/// site of one with several elements is their names, apart by blanks.
std::vector<PlacedEffect> FaultEffects(const mjModel& plant);

}  // namespace mjdiag
