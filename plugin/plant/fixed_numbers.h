#pragma once
// What of a plant is never in doubt, whatever a record says: numbers that act on its
// motion and are of no kind of model_parameter_kind.h. Lengths, gears of the geometry and
// limits, which every plant has, are not told.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjdiag {

/// "solref and solimp of 2 equalities", "dynprm of actuator 'valve'"; empty: none.
std::vector<std::string> FixedNumbers(const mjModel& model);

/// "never in doubt: ..." in one line; empty: nothing to say.
std::string NoteOfFixedNumbers(const mjModel& model);

}  // namespace mjdiag
