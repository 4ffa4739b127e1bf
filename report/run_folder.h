#pragma once
// The folder that commands write a run into.

#include <filesystem>

#include "mjdiag/report/report_document.h"

namespace mjdiag {

/// All pages of the folder, the worst verdict first, and its clip. InputError names the
/// file: no such folder, no page in it, a page or clip that is damaged or broken off.
Report ReadRunFolder(const std::filesystem::path& folder);

}  // namespace mjdiag
