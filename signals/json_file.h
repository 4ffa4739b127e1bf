#pragma once
// Records as JSON: an object of arrays, an array of objects (one a sample), or JSON lines
// (an object a line, one a sample).
//
//   {"time": [0, 0.01], "q": [[0.1, 0.2], [0.3, 0.4]], "motor": {"u [N m]": [0, 1]}}
//   [{"time": 0, "q": [0.1, 0.2], "motor": {"u [N m]": 0}}, {"time": 0.01, ...}]
//
// Both have the columns time, q[0], q[1] and motor/u. null, and what an object of a sample
// lacks, is missing. Texts are left out, but for those of an object `units` beside the
// arrays: {"units": {"q[0]": "rad"}}.

#include <filesystem>
#include <memory>
#include <string_view>

#include "mjdiag/signals/record_source.h"

namespace mjdiag {

/// Whether a text is JSON rather than a table: it begins as an object or an array of
/// objects or arrays does.
bool LooksLikeJson(std::string_view text);

/// @param text  the whole file
/// InputError with the place of what is not JSON, or if there are no numbers.
std::unique_ptr<RecordSource> OpenJson(const std::filesystem::path& file,
                                       std::string_view text);

}  // namespace mjdiag
