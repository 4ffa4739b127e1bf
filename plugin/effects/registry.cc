#include "mjdiag/plugin/effects/registry.h"

#include <algorithm>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {

const std::vector<const Effect*>& Effects() {
  static const std::vector<const Effect*> effects{
#define MJDIAG_EFFECT(Name) &Name(),
#include "mjdiag/plugin/effects/effect_list.h"
#undef MJDIAG_EFFECT
  };
  return effects;
}

const Effect& FindEffect(std::string_view name) {
  std::string known;
  for (const Effect* effect : Effects()) {
    if (effect->name() == name) return *effect;
    known += (known.empty() ? "" : ", ") + effect->name();
  }
  throw InputError("effect", "unknown effect '" + std::string(name) + "'",
                   "one of " + known);
}

const Effect& NoiseEffect() {
  static const Effect& noise =
      **std::ranges::find(Effects(), Form::kNoise, &Effect::form);
  return noise;
}

}  // namespace mjdiag
