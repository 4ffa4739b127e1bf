#pragma once
// The setup of a calibrated machine as text: the user's setup, edited and not
// generated, so that a diff shows the one key that is new.

#include <filesystem>
#include <string>

namespace mjdiag {

/// The setup file with `calibration`, a file beside it, in the place of an earlier one
/// or else in a line of its own behind that of the plant.
/// @param setup_file  one that ReadSetup accepts, or its folder
std::string CalibratedSetup(const std::filesystem::path& setup_file,
                            const std::string& calibration);

}  // namespace mjdiag
