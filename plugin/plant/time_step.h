#pragma once
// Whether a plant and its setup agree on time.

#include <mujoco/mujoco.h>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// InputError if the model's time step is not control tick / substeps.
void CheckTimeStep(const Setup& setup, const mjModel& model);

}  // namespace mjdiag
