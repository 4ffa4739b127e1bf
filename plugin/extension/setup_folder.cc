#include "mjdiag/plugin/extension/setup_folder.h"

#include <string>

#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/extension/calibrated_setup.h"
#include "mjdiag/plugin/extension/effects_file.h"
#include "mjdiag/plugin/extension/extended_plant.h"
#include "mjdiag/plugin/extension/setup_following.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/folder_update.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCalibrationFile = "calibration.json";

/// The setup's text, and what stands beside it.
void WriteBeside(const fs::path& folder, const fs::path& file,
                 const std::string& text) {
  MakeOutputFolder(folder);
  for (const auto& entry : fs::directory_iterator(file.parent_path())) {
    const fs::path name = entry.path().filename();
    if (!entry.is_regular_file() || name == file.filename()) continue;
    WriteTextFile(folder / name, ReadTextFile(entry.path()));
  }
  WriteTextFile(folder / "setup.toml", text);
}

}  // namespace

fs::path FileForOther(const fs::path& setup, const fs::path& folder) {
  const fs::path file = fs::absolute(FindSetupFile(setup));
  if (fs::exists(folder) && fs::equivalent(file.parent_path(), folder)) {
    throw InputError(folder.string(), "is the folder of the setup itself",
                     "another folder");
  }
  return file;
}

fs::path WriteExtendedSetup(const fs::path& folder, const fs::path& setup,
                            const Machine& machine, const Changes& changes) {
  MakeOutputFolder(folder);
  FolderUpdate update;
  const std::string plant =
      ExtendMjcf(machine.setup().plant, machine.plant(), changes, folder);
  const std::string text = ExtendSetup(setup, machine.setup(), changes.effects, folder);
  WriteTextFile(folder / "plant.xml", plant);
  WriteTextFile(folder / "setup.toml", text);
  const bool needs_python =
      NeedEffectsFile(EffectsOf(machine.plant())) || NeedEffectsFile(changes.effects);
  if (needs_python) WriteTextFile(folder / kEffectsFile, EffectsPython());
  update.Commit();
  if (!needs_python) RemoveEffectsFile(folder);
  return folder / "plant.xml";
}

void WriteCalibratedSetup(const fs::path& folder, const fs::path& setup,
                          const Calibration& calibration,
                          const DiagnosisDesign& filters) {
  const fs::path file = FileForOther(setup, folder);
  FolderUpdate update;
  WriteBeside(folder, file, CalibratedSetup(file, kCalibrationFile));
  WriteCalibration(folder / kCalibrationFile, calibration);
  WriteFilters(folder / kCalibratedFilters, filters);
  update.Commit();
}

void WriteSetupFollowing(const fs::path& folder, const fs::path& setup,
                         const Trajectory& trajectory) {
  const fs::path file = FileForOther(setup, folder);
  FolderUpdate update;
  WriteBeside(folder, file, SetupFollowing(file, trajectory));
  update.Commit();
}

}  // namespace mjdiag
