#include "mjdiag/studies/machine_study.h"

#include <algorithm>

#include "mjdiag/signals/error.h"

namespace mjdiag {

StudyOptions StudyOptions::PartOf(std::size_t part, std::size_t count) const {
  StudyOptions options = *this;
  options.progress = [this, part, count](double fraction) {
    if (!progress) return;
    progress((static_cast<double>(part) + fraction) / static_cast<double>(count));
  };
  return options;
}

std::vector<PointRuns> RunsByPoint(const RunPlanner& planner) {
  std::vector<PointRuns> points;
  for (std::int64_t i = 0; i < planner.runs(); ++i) {
    PlannedRun run = planner.Run(i);
    if (points.empty() || points.back().front().point != run.point)
      points.push_back({});
    points.back().push_back(std::move(run));
  }
  return points;
}

PlannedRun RunWith(const PlanAxis& fault, double value, std::uint64_t seed) {
  PlannedRun run;
  run.seed = seed;
  run.axes = {{&fault, value}};
  return run;
}

const PlanCase& CaseOf(const StudyPlan& plan, const std::string& name) {
  const auto found = std::ranges::find(plan.cases, name, &PlanCase::name);
  if (found != plan.cases.end()) return *found;
  throw InputError("plan '" + plan.name + "'", "lacks the case '" + name + "'",
                   "a [[case]] of that name");
}

void RequireFaults(const PlanCase& one, AxisValues values) {
  const bool fits =
      !one.axes.empty() && std::ranges::all_of(one.axes, [&](const PlanAxis& axis) {
        return (axis.kind == AxisKind::kFault || axis.kind == AxisKind::kDisturbance) &&
               axis.values.empty() == (values == AxisValues::kDrawn);
      });
  if (fits) return;
  throw InputError("case '" + one.name + "'", "is none of what this plan asks",
                   values == AxisValues::kDrawn ? "faults or disturbances with ranges"
                                                : "faults or disturbances with values");
}

std::vector<SizedFault> FaultsOf(const PlannedRun& run) {
  std::vector<SizedFault> faults;
  for (const DrawnAxis& drawn : run.axes) {
    if (drawn.present()) faults.push_back({drawn.axis->name, drawn.value});
  }
  return faults;
}

std::string PlantName(bool linear) {
  return linear ? "linear plant" : "nonlinear plant";
}

PreparedDiagnosis DiagnosisOn(const Machine& machine, bool linear) {
  DiagnosisSource source;
  source.nominal.linear = linear;
  return PrepareDiagnosis(machine, source);
}

}  // namespace mjdiag
