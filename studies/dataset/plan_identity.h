#pragma once
// What the results of a plan depend on.

#include <cstdint>
#include <string>

#include "mjdiag/studies/plan/study_plan.h"

namespace mjdiag {

/// Version, plan, setup, plant, records and calibration, to the last digit.
std::string PlanIdentity(const LoadedPlan& loaded);

/// A number that differs where the text does, but for one in four thousand millions.
std::uint64_t ChecksumOf(const std::string& identity);

}  // namespace mjdiag
