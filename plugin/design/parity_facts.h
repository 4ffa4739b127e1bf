#pragma once
// The linear programs of [AB383], Eq. 17 to 19 beside the bank of a machine: do they
// find a parity relation where the singular value decomposition finds a null space, and
// is it the same one?

#include <string>

#include "mjdiag/diagnosis/residuals/residual_bank.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// What the linear programs of Eq. 18 give for a machine and its degree.
struct ParityProgramFacts {
  int degree = 0;
  std::string norm;  ///< that was minimised: "one" or "infinity"
  int fault_inputs = 0;
  int programs = 0;
  int feasible = 0;
  double objective =
      0.0;  ///< the norm of the relation; these three only if one is feasible
  double defect = 0.0;  ///< ParityProgramSolution::defect
  double angle = 0.0;   ///< between relation and null space of the decomposition [rad]
};

/// Where the unknown forces of a setup enter the delta form; no columns: none.
SignalEntry UnknownForceEntry(const MechanicalModel& healthy,
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

}  // namespace mjdiag
