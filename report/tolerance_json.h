#pragma once
// `tolerance` of `mjdiag simulate --tolerate --json`: what a fault-tolerant run did.

#include <nlohmann/json.hpp>

#include "mjdiag/plugin/design/tolerant_run.h"

namespace mjdiag {

/// time_constant [s], sigmas, loop_radius, largest_loop_radius; axes [{name, gain,
/// least_gain, most_gain}]; faults [{name, action, value, since [s], acting, until [s] or
/// null}].
nlohmann::json ToleranceJson(const TolerantRun& run, const TolerancePlan& plan,
                             const Setup& setup);

}  // namespace mjdiag
