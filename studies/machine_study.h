#pragma once
// What all studies share: runs of a plan, the diagnosis of its machine, and what is seen in
// them.

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
  int runs = 200;
  std::uint64_t seed = 1;

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

/// What is wrong in a run.
std::vector<SizedFault> FaultsOf(const PlannedRun& run);
std::string PlantName(bool linear);  ///< "linear plant"

/// 0 for a disturbance of the setup, else 1.
double HealthyValue(const Setup& setup, const std::string& fault);

/// The setup's filters with limits from nominal runs of that plant.
PreparedDiagnosis DiagnosisOn(const Machine& machine, bool linear);

/// What a diagnosis sees.
struct Detection {
  std::optional<double> residual;  ///< when the residual left its limits [s]
  bool spectrum = false;           ///< tones or raised noise
  bool estimate = false;           ///< of the fault asked for
  double value = 0.0;              ///< its estimate
};

/// In a record, all of which is regressed. Cross terms of large faults stay in: the
/// faults here are single ones.
Detection Look(const PreparedDiagnosis& prepared, const Record& record,
               const std::string& fault);

}  // namespace mjdiag
