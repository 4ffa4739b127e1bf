#pragma once
// The tables of `mjdiag study --preset hidden`, `hidden_none` and `hidden_two`.

#include <mujoco/mujoco.h>

#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// options.runs runs with `causes` hidden effects each (0, 1 or 2), seeds from
/// options.seed on: one row a run, and how many were right.
std::vector<StudyTable> HiddenStudy(const Machine& machine, int causes,
                                    const StudyOptions& options);

}  // namespace mjdiag
