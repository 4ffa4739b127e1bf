#pragma once
// `mjdiag compare --json`: the figures of a comparison for other programs.

#include <nlohmann/json.hpp>

#include "mjdiag/discovery/comparison/comparison.h"

namespace mjdiag {

/// What comparison_fields.h describes.
nlohmann::json ToJson(const Comparison& comparison);

}  // namespace mjdiag
