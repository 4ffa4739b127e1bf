#include "mjdiag/studies/plan/study_plan.h"

#include <algorithm>

namespace mjdiag {

int PlanCase::dimensions() const {
  // A value, and for some a time, of every axis; which of its own axes vary takes one
  // number for how many and one for each of them.
  int count = static_cast<int>(axes.size());
  count += static_cast<int>(std::ranges::count_if(
      axes, [](const PlanAxis& axis) { return axis.appears.has_value(); }));
  if (choose) count += 1 + static_cast<int>(axes.size() - common);
  return count;
}

std::string SplitName(Split split) {
  switch (split) {
    case Split::kTrain:
      return "train";
    case Split::kValidation:
      return "validation";
    default:
      return "test";
  }
}

void StudyPlan::SetRuns(int runs) {
  bool drawn = false;
  for (PlanCase& one : cases) {
    if (one.method != PlanMethod::kRandom) continue;
    one.points = runs;
    drawn = true;
  }
  if (!drawn) replications = runs;
}

std::int64_t StudyPlan::RunsOfAMachine() const {
  std::int64_t points = 0;
  for (const PlanCase& one : cases) points += one.points;
  return points * static_cast<std::int64_t>(motions.size()) * replications;
}

}  // namespace mjdiag
