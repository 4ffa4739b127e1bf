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

/// One [[axis]], or of every disturbance of the setup one; every value that it can have is
/// one that machine and setup take.
std::vector<PlanAxis> ReadAxis(const TomlTable& table, const AxisSurroundings& around);

/// The axes of the key `sizes`: names of tables [studies.<name>] of the setup. The faults of
/// one table are at its values. Of several the first has the value of a fault that is
/// nearest to healthy, and the others farthest ones, on either side.
std::vector<PlanAxis> ReadSizes(const TomlTable& table, const Machine& machine);

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
