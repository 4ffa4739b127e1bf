#pragma once
// Tones and noise in the disturbance residual: [AB383], section 5.6.

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Of every point of the plan: tones found with their frequencies, the magnitude
/// estimated, and whether noise was called raised, over its replications.
std::vector<StudyTable> AnswerTo(const AskDisturbances& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
