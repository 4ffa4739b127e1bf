#pragma once
// What the filters of a machine start from: how much its readings tell, and from which
// degree on it has parity relations ([AB383], Fig. 15).

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/design/parity_facts.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// A machine with a fault.
struct ChangedMachine {
  std::string label;
  MechanicalModel model;
};

struct DesignFacts {
  int minimal_degree = 0;  ///< of a parity relation
  /// Of the observability stack up to every degree, from 0 to that of the setup.
  std::vector<int> observability_ranks;
  Eigen::Index states = 0;
  MechanicalModel healthy;
  std::vector<ChangedMachine> changed;  ///< for ChangePlot; may be empty
  std::optional<ParityProgramFacts> linear_program;
};

/// Of the machine as the healthy one; without changed ones.
/// @param linear_programs  whether to solve those, too, which takes long
/// InputError as SynthesisOf and SolveParityPrograms.
DesignFacts FactsOf(const Machine& machine, bool linear_programs);

/// The machine with each spring that may wear at a hundredth ([AB383], Fig. 30).
std::vector<ChangedMachine> WithoutStiffness(const Machine& machine);

}  // namespace mjdiag
