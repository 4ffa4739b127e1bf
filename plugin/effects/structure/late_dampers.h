#pragma once
// What the physics steps of a simulation do to the dampers of its joints. MuJoCo's Euler
// integrator has them act on the velocity at the end of a step h, half a step after the
// middle of which the velocity is that: a damping D is one together with a mass h D / 2. A
// machine that has no steps lacks that mass.

#include <optional>

#include "mjdiag/plugin/effects/placed_effect.h"

namespace mjdiag {

/// All dampers of a plant that much later [s], at most h / 2: its degrees of freedom are
/// lighter by `delay` times their damping. None of the effects that are looked for; none
/// where a plant has no joint with a name.
std::optional<PlacedEffect> LateDampers(const mjModel& plant, double delay);

}  // namespace mjdiag
