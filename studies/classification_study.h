#pragma once
// The residual-based diagnosis, the twin and a data-driven diagnosis on the same runs:
// [AB383], Table 4.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// For every case of the plan single faults, one axis after the other, each with a range on
/// one side of healthy in which sizes are even in their logarithm, and as many healthy runs
/// between them; half of the runs train the support vector machines, the other half is
/// judged by all methods. A case has as many runs as points. The residual-based method
/// detects by thresholds and spectrum and names the fault whose estimate is most
/// significant; the twin has to name the one fault and no other. Neither is trained.
std::vector<StudyTable> AnswerTo(const AskClasses& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
