#pragma once
// The columns of a log of which nobody has said yet what they are: their names, read, and
// its time.

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/draft/column_words.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

struct LogColumns {
  std::filesystem::path file;
  std::vector<ColumnWords> columns;    ///< those that are series beside the time
  std::optional<ColumnWords> time;     ///< none: no column can be one
  double interval = 0.0;               ///< usual time between rows [s]
  std::vector<std::string> assumed;    ///< what was taken for granted about the time
  std::vector<std::string> questions;  ///< what of it could not be told
};

/// The time is the column that is called so and grows. Without a unit it is in the one in
/// which the rows come at 5 Hz to 20 kHz, if that is one alone.
/// InputError as OpenRecordSource.
LogColumns ReadLogColumns(const std::filesystem::path& file);

/// Numbers of some columns as they stand in the file, without their units, at one interval;
/// channels are called by the columns. Nothing where a column cannot be read, or the log
/// has no time.
std::optional<Record> RawColumns(const LogColumns& log,
                                 const std::vector<std::string>& columns);

}  // namespace mjdiag
