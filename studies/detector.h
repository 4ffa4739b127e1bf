#pragma once
// The ways in which a fault is seen in a record of a machine, side by side: the residual
// of [AB383] and what else is made of it, and the twin.

#include <functional>
#include <string>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/studies/machine_study.h"

namespace mjdiag {

struct Detector {
  std::string name;
  /// That fault, in a record that has it and no other.
  std::function<bool(const Record&, const std::string& fault)> sees;
  /// Anything.
  std::function<bool(const Record&)> alarms;
  /// Only of faults for which this holds; none: of all.
  std::function<bool(const std::string& fault)> meant_for;
  /// It may be at the information bound, and a search begins there; looking at a run takes
  /// it longer than making one.
  bool at_bound = false;
};

/// The residual outside its limits.
Detector ByResidual(const std::string& name, const PreparedDiagnosis& prepared);
/// Tones of a disturbance, or raised noise.
Detector BySpectrum(const Setup& setup, const PreparedDiagnosis& prepared);
/// The estimate of the regression on residuals, of that fault.
Detector ByEstimate(const PreparedDiagnosis& prepared);
/// The twin names that fault and no other.
Detector ByTwin(const Machine& machine, bool linear);

}  // namespace mjdiag
