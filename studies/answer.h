#pragma once
// The one door to all studies: what a plan asks, answered in tables.

#include <vector>

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// InputError of a plan that asks nothing.
std::vector<StudyTable> AnswerTo(const LoadedPlan& plan, const StudyOptions& options);

}  // namespace mjdiag
