#pragma once
// A run under fault-tolerant control (fault_tolerance.h), whole: the diagnosis in the
// control callback, what acts on what it finds, the run, and both answers at its end.

#include <functional>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/design/fault_tolerance.h"

namespace mjdiag {

struct TolerantRun {
  Record record;
  Diagnosis diagnosis;
  std::vector<Tolerated> faults;  ///< that were acted on
  std::vector<double> gains;      ///< of the loop of every axis, at the end
};

/// @param machine  the healthy one, which `prepared` and `plan` are made for
/// @param samples  of the run
/// @param options  of the run; its observer and reconfiguration are replaced
/// @param run      makes it with such options: of the worn machine, or of its linear model
/// InputError if the diagnosis has no twin.
TolerantRun RunTolerantly(const Machine& machine, const PreparedDiagnosis& prepared,
                          const TolerancePlan& plan, Eigen::Index samples,
                          RunOptions options,
                          const std::function<Record(const RunOptions&)>& run);

}  // namespace mjdiag
