#pragma once
// How a joint that rubs stands: it holds, as the textbook has it; gives way, as simulations do;
// springs, as guides and gears do before they slide [Dahl 1968]; holds by more than it slides by
// [Stribeck 1902]. Which of them it is shows where it stands, and behind the latent forces of a
// machine that lacks its friction first order says nothing of it: the filter is asked.

#include <optional>

#include "mjdiag/discovery/fit/converged_model.h"

namespace mjdiag {

/// Whether the speed is known within which every friction comes, of which there is one.
bool AreSpeedsKnown(const std::vector<Block>& blocks, const ModelFit& fit);

/// The same model with its dry friction in the best of the other forms, fitted and with its
/// noise anew; none if that is no better.
/// @param every_form  else only what springs, for which a filter is quick: what sticks takes it
///                    many times as long
std::optional<ConvergedModel> WithOtherFriction(const ConvergedBeside& beside,
                                                const ConvergedModel& found,
                                                bool every_form);

}  // namespace mjdiag
