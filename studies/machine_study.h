#pragma once
// What all studies share: runs of a plan, and the diagnosis of its machine.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/studies/growing_table.h"
#include "mjdiag/studies/plan/run_machine.h"

namespace mjdiag {

/// A fault parameter or disturbance with its value.
struct SizedFault {
  std::string name;
  double value = 1.0;
};

/// How one hears of a study while it runs.
struct StudyOptions {
  std::function<void(double fraction)> progress;
  RowSink row;  ///< sees tables grow; may be called from any thread

  /// Of part `part` of `count` equal ones; this must outlive it.
  StudyOptions PartOf(std::size_t part, std::size_t count) const;
};

/// Runs of a plan that differ in their noise only.
using PointRuns = std::vector<PlannedRun>;
/// All of them, point by point.
std::vector<PointRuns> RunsByPoint(const RunPlanner& planner);

/// A run with that fault alone, on the machine of the setup.
PlannedRun RunWith(const PlanAxis& fault, double value, std::uint64_t seed);
/// The case of that name; InputError if there is none.
const PlanCase& CaseOf(const StudyPlan& plan, const std::string& name);

enum class AxisValues { kListed, kDrawn };
/// InputError if a case has no axes, or others than faults and disturbances with such values.
void RequireFaults(const PlanCase& one, AxisValues values);

/// What is wrong in a run.
std::vector<SizedFault> FaultsOf(const PlannedRun& run);
std::string PlantName(bool linear);  ///< "linear plant"

/// The setup's filters with limits from nominal runs of that plant.
PreparedDiagnosis DiagnosisOn(const Machine& machine, bool linear);

}  // namespace mjdiag
