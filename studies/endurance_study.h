#pragma once
// One long run: the machine repeats its default motion for hours, with the diagnosis and
// its twin in the control callback, and nothing is kept of it but a row now and then. A
// healthy machine must not be named faulty, what wears evenly must be followed, and
// neither memory nor the time of a tick may grow.

#include <vector>

#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// The run of `duration` on the plan's plant, a row for every `every`; faults of `wear`
/// grow evenly from healthy. What the twin says is looked at every tenth of a second, and a
/// row says all that it said since the last one. InputError on a wear of what is no fault
/// parameter of the plant.
std::vector<StudyTable> AnswerTo(const AskEndurance& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options);

}  // namespace mjdiag
