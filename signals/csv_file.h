#pragma once
// Records as text: a header row `time [s],x [m],"a, b [N]"`, then one row a sample.
//
// Read: separated by comma, semicolon or tab (whichever the header row uses), LF or
// CRLF, units in square brackets or parentheses (column_name.h), quoted headers and cells,
// comment lines that begin with # before the header, blank lines anywhere, a byte-order
// mark.

#include <filesystem>
#include <memory>
#include <string>

#include "mjdiag/signals/record.h"
#include "mjdiag/signals/record_source.h"

namespace mjdiag {

/// @param text  the whole file
/// InputError if there is no header row or nothing below it.
std::unique_ptr<RecordSource> OpenCsv(const std::filesystem::path& file,
                                      std::string text);

/// The record as text; every number has the fewest digits that read back bitwise the
/// same.
std::string FormatCsv(const Record& record);

}  // namespace mjdiag
