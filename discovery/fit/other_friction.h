#pragma once
// Joints that rub hold where they stand, as machines do, or give way, as simulations do: which
// of both costs nothing, as the steps of a simulation do not, and the filter says it.

#include <optional>

#include "mjdiag/discovery/fit/converged_model.h"

namespace mjdiag {

/// The same model with its dry friction in the other of the two forms, fitted and with its noise
/// anew; none if that is no better.
std::optional<ConvergedModel> WithOtherFriction(const ConvergedBeside& beside,
                                                const ConvergedModel& found);

}  // namespace mjdiag
