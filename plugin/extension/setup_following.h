#pragma once
// A setup with one more trajectory as text: the user's setup, edited and not generated.

#include <filesystem>
#include <string>

#include "mjdiag/controllers/trajectory.h"

namespace mjdiag {

/// The setup file with the trajectory behind everything else, and as the default one.
/// @param setup_file  one that ReadSetup accepts, or its folder. InputError if it has a
///                    trajectory of that name
std::string SetupFollowing(const std::filesystem::path& setup_file,
                           const Trajectory& trajectory);

}  // namespace mjdiag
