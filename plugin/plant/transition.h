#pragma once
// The linear map of one control tick by finite differences of MuJoCo's own integrator:
// slower and less accurate than TickModel, and independent of it.

#include <mujoco/mujoco.h>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// mjd_transitionFD of one physics step about the static equilibrium, with static
/// friction off, applied `substeps` times. x = [q; v], u and y are the channels. Takes the control callback off meanwhile: not to be called while
/// simulations run in other threads.
StateSpace TickByFiniteDifferences(const mjModel& model, const Channels& channels,
                                   int substeps);

}  // namespace mjdiag
