#pragma once
// What the members of a model do along a run, as exact columns (tick_columns.h): by every
// coordinate of each, what leaving one out would do, and what other physics steps do.

#include <vector>

#include "mjdiag/discovery/fit/model_fit.h"
#include "mjdiag/discovery/regression/moves.h"

namespace mjdiag {

struct ExactColumns {
  std::vector<Term> terms;
  Column other_steps;
};

/// @param other_steps  the machine with the model and other physics steps
ExactColumns ExactColumnsOf(const MachineWith& machine_with, const Machine& other_steps,
                            const MeasuredRun& run, const FilterPath& path,
                            const std::vector<Block>& blocks, const Model& model);

}  // namespace mjdiag
