#pragma once
// The linear programs of [AB383], Eq. 17 to 19 beside the bank of `mjdiag design`:
// do they find a parity relation where the singular value decomposition finds a null
// space, and is it the same one?

#include "app/subject.h"
#include "mjdiag/diagnosis/residuals/residual_bank.h"
#include "mjdiag/report/design_page.h"

namespace mjdiag::app {

/// Where the unknown forces of a setup enter the delta form; no columns: none.
SignalEntry UnknownForces(const MechanicalModel& healthy,
                          const SynthesisOptions& options);

/// Poses the programs on the delta form of the control tick in coordinates of unit
/// mass, with the unknown forces of the setup as unknown inputs and the forces that the
/// fault parameters of the plant change as faults, at the degree of the setup.
///
/// Fault inputs are directions of generalised force, each of unit length in the
/// coordinates of the delta form, so that the size of the relation does not depend on
/// their units. InputError if the plant has no fault parameters.
ParityProgramFacts SolveParityPrograms(const Machine& machine,
                                       const MechanicalModel& healthy);

}  // namespace mjdiag::app
