#pragma once
// Machines that nobody knows exactly: the numbers of each are drawn about those of the plant,
// it is calibrated on a few healthy runs, and the twin of what was learned is asked about
// healthy runs that it has not seen, and about faults of sizes that it promises to name.

#include <vector>

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// A machine for every replication of the plan. Logarithms of all numbers are drawn with the
/// standard deviations that they have without measuring (UsualSpread).
std::vector<StudyTable> AnswerTo(const AskCalibration& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
