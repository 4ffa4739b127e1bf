#pragma once
// Plans that ship for any machine: those of mjcf/ab383/plans that ask something.

#include <string>
#include <vector>

#include "mjdiag/studies/plan/study_plan.h"

namespace mjdiag {

std::vector<std::string> PresetNames();

/// The plan of that name for a machine: its own, plans/<name>.toml beside its setup, or the
/// one that ships. InputError as ReadPlan, and on a name that is neither.
LoadedPlan ReadPreset(const std::string& name, const Machine& machine);

}  // namespace mjdiag
