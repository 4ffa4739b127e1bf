#pragma once
// Records as MATLAB files, versions 5 and 7.3: one real vector a channel, a variable
// `time` [s], a struct `units` with a field a variable, and a struct `names` with the
// channel's name for every variable (MATLAB's names allow no dot, for example).
//
// Read: version 5 (also compressed, either byte order) and 7.3; files of others need
// neither `units` nor `names`. A vector may be a row or a column of any numeric class. The
// columns of a matrix, along whose longer dimension the samples are, are columns of their
// own (column_name.h), and so are the fields of a struct, "log/q".

#include <filesystem>
#include <memory>

#include "mjdiag/signals/record.h"
#include "mjdiag/signals/record_file.h"
#include "mjdiag/signals/record_source.h"

namespace mjdiag {

/// InputError if the file is cut off or damaged, or has no variables.
std::unique_ptr<RecordSource> OpenMat(const std::filesystem::path& file);

/// @param format  kMat5 or kMat73
/// InputError if the file cannot be written.
void WriteMat(const std::filesystem::path& file, const Record& record,
              RecordFormat format);

}  // namespace mjdiag
