#pragma once
// The benchmark of discovery in tables: one row a case, what became of them, and, where the
// model is not exact, how reliable the probabilities are.

#include <vector>

#include "mjdiag/studies/hidden_study.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// What became of cases of a model that is not exact, and the reliability of their
/// probabilities.
std::vector<StudyTable> SummariesOf(const std::vector<HiddenOutcome>& outcomes);

}  // namespace mjdiag
