#pragma once
// A study of one's own, and what it found, as Python has them.

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/studies/dataset/plan_run.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag::python {

/// A plan with its machine. Does not change.
struct StudyObject {
  std::shared_ptr<const LoadedPlan> loaded;
  std::shared_ptr<const RunPlanner> planner;  ///< of it
};

struct StudyResultObject {
  StudyObject study;
  PlanOutcome outcome;
  std::vector<StudyTable> tables;
};

/// @param plan  a path, TOML, or a dict of what the TOML would have
StudyObject StudyOf(const pybind11::object& plan);

/// Columns of the runs: name -> numpy array or list of texts, each as long as the runs.
pybind11::dict RunColumns(const StudyResultObject& result);

}  // namespace mjdiag::python
