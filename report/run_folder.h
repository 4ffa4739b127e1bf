#pragma once
// The folder that commands write a run into, and its report.

#include <filesystem>

#include "mjdiag/report/report.h"

namespace mjdiag {

/// All pages of the folder, the worst verdict first, and its clip. InputError names the
/// file: no such folder, no page in it, a page or clip that is damaged or broken off.
Report ReadRunFolder(const std::filesystem::path& folder);

/// Makes `<folder>/report.html`. @return its path. InputError as above, or if the plot
/// library is not installed or the folder not writable; an older report is then still
/// whole.
std::filesystem::path WriteReport(const std::filesystem::path& folder);

}  // namespace mjdiag
