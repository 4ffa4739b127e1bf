#pragma once
// What an extended plant carries and MJCF has no attributes for, for the Python package of
// any MuJoCo: a file effects.py beside plant.xml. It is the same beside every plant, for it
// reads the numerics from the model. Its sources are effects_laws.py, one function a law, and
// effects_step.py, which is ActiveEffects (plugin/effects/active_effect.h) again.

#include <filesystem>
#include <string_view>
#include <vector>

#include "mjdiag/plugin/effects/placed_effect.h"

namespace mjdiag {

inline constexpr const char* kEffectsFile = "effects.py";

/// The text of the file.
std::string_view EffectsPython();

/// Whether some of these effects are carried as numerics.
bool NeedEffectsFile(const std::vector<PlacedEffect>& effects);

/// Takes away a file of that name that is one of these, of an earlier plant.
void RemoveEffectsFile(const std::filesystem::path& folder);

}  // namespace mjdiag
