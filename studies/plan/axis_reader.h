#pragma once
// The parts of a plan that name what a machine has: its axes of variation, and what is
// kept of a run.

#include <string_view>

#include "mjdiag/plugin/setup/toml_table.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/plan/study_plan.h"

namespace mjdiag {

/// What the names in an axis mean.
struct AxisSurroundings {
  const StudyPlan& plan;
  const Machine& machine;
};

/// One [[axis]]; every value that it can have is one that machine and setup take.
PlanAxis ReadAxis(const TomlTable& table, const AxisSurroundings& around);

/// [keep]
PlanKeep ReadKeep(const TomlTable& root, const Machine& machine);

/// Does what may complain of a value of the key, and says where that is.
template <typename Work>
void WithPlace(const TomlTable& table, std::string_view key, const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    throw InputError(table.Where(key) + ": " + error.what());
  }
}

}  // namespace mjdiag
