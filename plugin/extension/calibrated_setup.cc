#include "mjdiag/plugin/extension/calibrated_setup.h"

#include "mjdiag/plugin/extension/setup_text.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

std::string CalibratedSetup(const std::filesystem::path& setup_file,
                            const std::string& calibration) {
  SetupText text(FindSetupFile(setup_file));
  text.SetBeside("plant", "calibration", '"' + calibration + '"');
  return text.Text();
}

}  // namespace mjdiag
