#pragma once
// A residual for the nonlinear machine: among all parity relations of a null space, of
// a higher degree than else, that which recorded nominal runs of the nonlinear plant
// excite least while it sees one fault ([AB383], section 6). The linear model does not
// know friction in the guides; its residual is full of it.

#include <mujoco/mujoco.h>

#include <string>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

/// Filters like those of DesignFilters, but with the degree and denominator of the
/// setup's [diagnosis.robust] and the one relation that LeastExcitedRelation finds for
/// the fault (a fault parameter of the plant or a disturbance of the setup, InputError
/// on another).
/// @param excitation  motion of the nominal runs
/// @param baseline    judge relations by what differs between runs, for a diagnosis
///                    that subtracts a baseline
DiagnosisDesign DesignRobustFilters(const Machine& machine, const std::string& fault,
                                    const Excitation& excitation, bool baseline);

}  // namespace mjdiag
