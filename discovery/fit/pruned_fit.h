#pragma once
// A fitted model without the members that the fit has made nothing of: a size that is known
// to be about 0, and is now so close to it that the member costs more than it is worth.

#include <functional>
#include <vector>

#include "mjdiag/discovery/fit/model_fit.h"

namespace mjdiag {

/// Without members of no size at all, which change nothing: there is nothing to fit.
ModelFit WithoutIdle(const std::vector<Block>& blocks, ModelFit fit);

using FitOf = std::function<ModelFit(const Model& start)>;

/// A resistance that has a name is not taken out beside a curve without one over the same
/// velocity, which can be anything.
/// @param fit_of  fits anew without one
ModelFit Pruned(const std::vector<Block>& blocks, ModelFit fit, const FitOf& fit_of);

}  // namespace mjdiag
