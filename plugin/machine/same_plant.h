#pragma once
// Whether two models are the same, number by number.

#include <mujoco/mujoco.h>

namespace mjdiag {

bool AreSamePlant(const mjModel& a, const mjModel& b);

}  // namespace mjdiag
