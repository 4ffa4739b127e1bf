#pragma once
// What a study of one's own found, in tables and plots: how often faults of which size
// are named, what is taken for what, and how far estimates are off.

#include <vector>

#include "mjdiag/studies/dataset/plan_run.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// The runs of every case; with verdicts or estimates kept also, of every fault that
/// varies, the share of runs that name it over its size, the confusion matrix of names,
/// and the errors of the estimates over their standard deviations.
std::vector<StudyTable> PlanTables(const PlanOutcome& outcome);

}  // namespace mjdiag
