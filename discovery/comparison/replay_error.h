#pragma once
// Relative errors of a replay without noise, for every channel and derived signal: the
// figures by which a machine's models are compared in the literature.

#include <mujoco/mujoco.h>

#include <map>
#include <string>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// Channel or derived signal -> 100 ||measured - simulated|| / ||measured|| [%], after
/// setup.compare.skip_samples. Of a replay that diverges: infinity for the first
/// sensor.
std::map<std::string, double> ReplayErrors(const Machine& machine,
                                           const Record& measured);

}  // namespace mjdiag
