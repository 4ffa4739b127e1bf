#pragma once
// Whether a plan can be run, before hours of it have been.

#include <string>

#include "mjdiag/studies/plan/study_plan.h"

namespace mjdiag {

/// Runs the first ticks of some runs of every case. InputError names the case.
/// @param where  what the plan is called
void CheckPlan(const LoadedPlan& loaded, const std::string& where);

}  // namespace mjdiag
