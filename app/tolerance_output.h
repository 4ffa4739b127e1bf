#pragma once
// What a fault-tolerant run says of itself.

#include <string>
#include <vector>

#include "mjdiag/plugin/design/fault_tolerance.h"

namespace mjdiag::app {

/// The table for people: what was corrected, and since when.
std::string DescribeTolerance(const std::vector<Tolerated>& faults);

}  // namespace mjdiag::app
