#include "mjdiag/plugin/extension/effects_file.h"

#include <algorithm>
#include <system_error>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {

bool NeedEffectsFile(const std::vector<PlacedEffect>& effects) {
  return std::ranges::any_of(effects, [](const PlacedEffect& placed) {
    return placed.effect->form() == Form::kNumeric;
  });
}

void RemoveEffectsFile(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kEffectsFile;
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return;
  // Whatever version wrote it.
  const std::string_view first = EffectsPython().substr(0, EffectsPython().find('\n'));
  if (ReadTextFile(file).starts_with(first)) std::filesystem::remove(file, none);
}

}  // namespace mjdiag
