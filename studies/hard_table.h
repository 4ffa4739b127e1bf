#pragma once
// The tables of `mjdiag study --preset hidden_hard` and `hidden_hard_none`.

#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/studies/hard_study.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// options.runs cases, seeds from options.seed on: one row a case, what became of them,
/// and how reliable the probabilities are.
/// @param nothing  there is nothing hidden in any of them, but wrong numbers
std::vector<StudyTable> HardStudy(const Machine& model, bool nothing,
                                  const StudyOptions& options);

/// What became of them, and the reliability of their probabilities.
std::vector<StudyTable> SummariesOf(const std::vector<HardOutcome>& outcomes);

}  // namespace mjdiag
