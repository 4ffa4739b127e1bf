#pragma once
// Whether a plant and its setup agree on time.

#include <mujoco/mujoco.h>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// Steps that are off by less have too few digits, or are of a record with a clock of its own.
inline constexpr double kNearStep = 0.01;

/// Sets the model's time step to control tick / substeps where it is near; InputError if it is
/// not.
void AdoptTimeStep(const Setup& setup, mjModel& model);

/// InputError if the model's time step is not control tick / substeps.
void CheckTimeStep(const Setup& setup, const mjModel& model);

}  // namespace mjdiag
