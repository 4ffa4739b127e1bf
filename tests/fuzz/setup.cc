// setup.toml and the files that it names; what is added to a setup that is accepted has to
// leave it so.

#include "mjdiag/plugin/setup/setup.h"

#include "fuzz/target.h"
#include "mjdiag/controllers/trajectory.h"
#include "mjdiag/plugin/extension/calibrated_setup.h"
#include "mjdiag/plugin/extension/extended_plant.h"
#include "mjdiag/plugin/extension/setup_following.h"
#include "mjdiag/plugin/setup/calibration_file.h"
#include "mjdiag/plugin/setup/chain_file.h"
#include "mjdiag/plugin/setup/published_relation_file.h"

namespace mjdiag::fuzz {
namespace {

Setup Reread(const std::string& text) {
  return ReadSetup(WriteFile("edited.toml", text));
}

void Edit(const std::filesystem::path& file, const Setup& setup) {
  MustDo("an extended setup", [&] {
    Require(Reread(ExtendSetup(file, setup, {}, Folder() / "extended"))
                .name.ends_with("(extended)"),
            "an extended setup without its name");
  });
  MustDo("a calibrated setup", [&] {
    Require(Reread(CalibratedSetup(file, "calibration.json")).calibration.has_value(),
            "a calibrated setup without a calibration");
  });
  if (setup.control.axes.empty()) return;
  Trajectory trajectory;
  trajectory.name = "an_added_one";
  trajectory.duration = 1.0;
  trajectory.ramp = 0.1;
  trajectory.tones = {
      {setup.control.axes.front().name, 0.1 * setup.rates.control, 1e-3, 0.0}};
  std::string text;
  // There may be one of that name.
  if (!Done([&] { text = SetupFollowing(file, trajectory); })) return;
  if (setup.rates.control > 1e6) return;
  MustDo("a setup with a trajectory", [&] {
    Require(Reread(text).trajectories.fallback == trajectory.name,
            "a setup that follows another trajectory");
  });
}

}  // namespace

void FuzzSetup(Input input) {
  const auto file = WriteFile("fuzzed.toml", TextOf(input));
  Setup setup;
  if (Done([&] { setup = ReadSetup(file); })) Edit(file, setup);
  Done([&] { ReadLinearChain(file); });
  Done([&] { ReadPublishedRelation(file); });
  Done([&] { ReadCalibration(file); });
}

}  // namespace mjdiag::fuzz
