// The setup of an extended plant: ExtendSetup of extended_plant.h.

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/extension/extended_plant.h"
#include "mjdiag/plugin/extension/setup_text.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

void WriteNoise(SetupText& text, const Setup& setup, const SensorSetup& sensor,
                double sd) {
  const std::string path = "sensors." + sensor.channel;
  if (const auto given = text.At(path + ".noise_sd")) {
    text.Replace(*given.node(), AllDigits(sd));
  } else if (const auto power = text.At(path + ".noise_power")) {
    text.Replace(*power.node(), AllDigits(sd * sd / setup.rates.control));
  } else if (const auto element = text.At(path + ".element")) {
    text.AddBeside(*text.At(path).as_table(), *element.node(), "element", "noise_sd",
                   AllDigits(sd));
  }
}

void WriteSubsteps(SetupText& text, int substeps) {
  const auto given = text.At("rates.substeps");
  if ((given ? given.value_or(1) : 1) == substeps) return;
  if (given) {
    text.Replace(*given.node(), std::to_string(substeps));
  } else if (const auto control = text.At("rates.control")) {
    text.AddBeside(*text.At("rates").as_table(), *control.node(), "control", "substeps",
                   std::to_string(substeps));
  }
}

/// Puts `suffix` in front of the closing quotation marks of a TOML string.
std::string WithSuffix(std::string quoted, const std::string& suffix) {
  const bool multiline = quoted.starts_with(R"(""")") || quoted.starts_with("'''");
  return quoted.insert(quoted.size() - (multiline ? 3 : 1), suffix);
}

}  // namespace

std::string ExtendSetup(const fs::path& setup_file, const Setup& setup,
                        const std::vector<PlacedEffect>& effects,
                        const fs::path& folder) {
  const fs::path file = FindSetupFile(setup_file);
  std::error_code ignored;
  if (fs::equivalent(file, folder / "setup.toml", ignored)) {
    throw InputError(folder.string(), "holds the nominal setup", "another folder");
  }
  SetupText text(file);
  const std::string kSuffix = " (extended)";
  const toml::node& name = *text.At("name").node();
  if (!name.value_or(std::string()).ends_with(kSuffix)) {
    text.Replace(name, WithSuffix(text.Raw(name), kSuffix));
  }
  text.Replace(*text.At("plant").node(), R"("plant.xml")");
  // What was calibrated is in the plant, its noise in the sensors below.
  for (const char* key : {"analytic", "published", "calibration"}) {
    if (const auto old = text.At(key)) text.RemoveLines(*old.node());
  }
  if (const auto friction = text.At("physics.static_friction")) {
    text.Replace(*friction.node(), "true");
  }
  WriteSubsteps(text, setup.rates.substeps);
  for (const SensorSetup& sensor : setup.channels.sensors) {
    double sd = sensor.noise_sd;
    for (const PlacedEffect& placed : effects) {
      if (placed.site != sensor.element) continue;
      sd = placed.effect->NoiseSd(sd, placed.values);
    }
    if (sd != sensor.noise_sd || setup.calibration) WriteNoise(text, setup, sensor, sd);
  }
  return text.Text();
}

}  // namespace mjdiag
