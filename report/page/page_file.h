#pragma once
// A page in a file, "<name>.page.json".

#include <filesystem>
#include <string>

#include "mjdiag/report/page/page.h"

namespace mjdiag {

/// Ending of the files.
inline constexpr const char* kPageEnding = ".page.json";

/// Replaces `<folder>/<name>.page.json` in one step. InputError if it cannot be
/// written.
void WritePage(const std::filesystem::path& folder, const std::string& name,
               const Page& page);

}  // namespace mjdiag
