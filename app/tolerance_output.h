#pragma once
// What a fault-tolerant run says of itself.

#include <nlohmann/json.hpp>
#include <string>

#include "mjdiag/plugin/design/fault_tolerance.h"

namespace mjdiag::app {

/// The table for people: what was corrected, and since when.
std::string DescribeTolerance(const Reconfiguration& reconfiguration,
                              const Setup& setup);

/// The same for machines to read, with the limits that it kept.
nlohmann::json ToleranceJson(const Reconfiguration& reconfiguration,
                             const TolerancePlan& plan, const Setup& setup);

}  // namespace mjdiag::app
