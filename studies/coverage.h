#pragma once
// How many true values lie in the intervals that discovery gives of them.

#include <mujoco/mujoco.h>

#include <vector>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

struct Coverage {
  int parameters = 0;  ///< of the causes of the truth that are named
  int inside = 0;      ///< of them inside their 95 % interval
};

Coverage CoverageOf(const mjModel& plant, const std::vector<Cause>& truth,
                    const std::vector<FoundCause>& found);

}  // namespace mjdiag
