#pragma once
// A page in a file, "<name>.page.json".

#include <filesystem>

#include "mjdiag/report/page.h"

namespace mjdiag {

/// Ending of the files.
inline constexpr const char* kPageEnding = ".page.json";

/// Replaces `<folder>/<name>.page.json` in one step. InputError if it cannot be
/// written.
void WritePage(const std::filesystem::path& folder, const std::string& name,
               const Page& page);

/// A page as its file has it, ready for a report. InputError with the file and the
/// place in it: not readable, not JSON (half-written), another schema, a missing or
/// misshapen part.
nlohmann::json ReadPageDocument(const std::filesystem::path& file);

}  // namespace mjdiag
