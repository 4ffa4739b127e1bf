#pragma once
// How a joint that rubs stands: it holds, as the textbook has it; gives way, as simulations do;
// springs, as guides and gears do before they slide [Dahl 1968]; holds by more than it slides by
// [Stribeck 1902]. Which of them it is shows where it stands, and behind the latent forces of a
// machine that lacks its friction first order says nothing of it: the filter is asked.

#include <optional>

#include "mjdiag/discovery/fit/converged_model.h"

namespace mjdiag {

/// The same model with its dry friction in the best of the other forms, fitted and with its
/// noise anew; none if that is no better.
/// @param has_time  for a fit of each before they are compared
std::optional<ConvergedModel> WithOtherFriction(const ConvergedBeside& beside,
                                                const ConvergedModel& found,
                                                bool has_time);

}  // namespace mjdiag
