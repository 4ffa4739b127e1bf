#include "mjdiag/studies/preset/preset_plan.h"

#include <filesystem>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/studies/preset/shipped_plans.h"

namespace mjdiag {

std::vector<std::string> PresetNames() {
  std::vector<std::string> names;
  for (const ShippedPlan& plan : ShippedPlans()) names.emplace_back(plan.name);
  return names;
}

LoadedPlan ReadPreset(const std::string& name, const Machine& machine) {
  const std::filesystem::path own = machine.setup().folder / "plans" / (name + ".toml");
  if (std::filesystem::is_regular_file(own)) {
    return ParsePlanFor(machine, ReadTextFile(own), own.string());
  }
  for (const ShippedPlan& plan : ShippedPlans()) {
    if (name != plan.name) continue;
    return ParsePlanFor(machine, plan.text, "preset " + name);
  }
  throw InputError("preset '" + name + "'", "there is none",
                   "one of " + Listed(PresetNames()));
}

}  // namespace mjdiag
