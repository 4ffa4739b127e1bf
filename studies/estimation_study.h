#pragma once
// How well all faults are estimated when they are present at once: [AB383],
// section 5.5, with intervals whose coverage is counted.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// For every point of the plan: mean estimate over its replications, largest error as a
/// share of the deviation, standard deviation claimed and found, how often the 95 %
/// interval held the truth with the binomial 99 % band of that count, and the multiple of
/// the information bound. Every fault parameter and disturbance is estimated, by the twin
/// of the machine (twin_estimator.h).
std::vector<StudyTable> AnswerTo(const AskEstimates& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
