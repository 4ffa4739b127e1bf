#pragma once
// The texts of plans, in the library (shipped_plans.cc.in).

#include <vector>

namespace mjdiag {

struct ShippedPlan {
  const char* name;
  const char* text;
};

/// By name.
const std::vector<ShippedPlan>& ShippedPlans();

}  // namespace mjdiag
