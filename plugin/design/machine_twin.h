#pragma once
// The twin of a machine for its diagnosis: the exact linear map where the machine is
// taken as linear, else its plant in MuJoCo, with all fault parameters and disturbances
// as unknowns, and the dry friction of the nonlinear plant beside them.

#include <memory>

#include "mjdiag/diagnosis/twin/linear_twin.h"
#include "mjdiag/diagnosis/twin/twin_estimator.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// What may be wrong with the linear plant of a machine.
UncertainModel MakeUncertainModel(const Machine& machine);

/// InputError on a machine whose sensors have no noise: it says how sure the twin is of
/// what it sees.
MachineTwin MakeTwin(const Machine& machine, bool linear);

/// An estimator with that twin; null where there is nothing to estimate or a sensor has
/// no noise.
std::unique_ptr<TwinEstimator> MakeTwinEstimator(const Machine& machine, bool linear);

}  // namespace mjdiag
