#pragma once
// All effects, by a function each and as a list. A new one is a file that defines its
// function and a line in effect_list.h.

#include <string_view>
#include <vector>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

#define MJDIAG_EFFECT(Name) const Effect& Name();
#include "mjdiag/plugin/effects/effect_list.h"
#undef MJDIAG_EFFECT

/// All of them, in the order of the list and of docs/effects.md.
const std::vector<const Effect*>& Effects();
/// The one of that name; InputError lists the known ones.
const Effect& FindEffect(std::string_view name);
/// White noise of a sensor: the effect that shows in the variance of the innovations
/// and not in their course.
const Effect& NoiseEffect();

}  // namespace mjdiag
