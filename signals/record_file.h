#pragma once
// Records in files. CSV has a header row `time [s],x [m],u_x [N]` (csv_file.h); MAT
// (v5, v7.3) has one variable a channel and a struct `units` with the same field names
// (mat_file.h). Logs in JSON (json_file.h) and HDF5 (hdf5_file.h) are read as well. Units
// of a foreign file may come from the column map.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/signals/measured_columns.h"
#include "mjdiag/signals/record.h"
#include "mjdiag/signals/record_source.h"
#include "mjdiag/signals/resampling.h"

namespace mjdiag {

enum class RecordFormat { kCsv, kMat5, kMat73 };

/// Where a channel lies in a foreign file.
struct ColumnSpec {
  std::string channel;  ///< name in the Record
  std::string column;   ///< header (without unit), dataset or variable
  /// Unit of the numbers in the file, converted to SI; goes before what the file says.
  /// Empty: the file's; a file without one holds pure numbers, and seconds.
  std::string unit = {};
  bool optional = false;  ///< a file without it is fine
};

/// How a foreign file becomes a record. Columns that are not named are not read.
struct ColumnMap {
  ColumnSpec time{"time", "time", "", false};
  std::vector<ColumnSpec> columns;
};

/// The columns of a file as they are, for those who do not know yet which they want; the
/// format follows from the file's first bytes. InputError if it is none that is read here.
std::unique_ptr<RecordSource> OpenRecordSource(const std::filesystem::path& file);

/// Reads a record; the format follows from the file's first bytes. Without a map every
/// column with a header is a channel, and "time" is the time.
/// The sample time is the simplest one that the times agree with, see uniform_time.h.
/// InputError (file, line or column, what was expected) on: unreadable or empty file,
/// no such column, unknown unit, a cell that is not a finite number, ragged rows, fewer
/// than two samples, time not increasing or not uniform (more than 1 % of a sample off
/// the uniform grid), truncated MAT, a MAT variable that is not a real vector.
Record ReadRecord(const std::filesystem::path& file,
                  const std::optional<ColumnMap>& map = std::nullopt);

/// The same of a file whose times may be irregular, or at another rate than is wanted, and
/// in which values may be missing: see measured_columns.h. A last row of CSV that was not
/// written to its end is left out.
MeasuredFile ReadMeasuredFile(const std::filesystem::path& file,
                              const std::optional<ColumnMap>& map,
                              const Resampling& resampling);

/// Writes all channels and the time, to a temporary name that is renamed at the end.
/// Reading the file back gives bitwise the same samples. InputError on what could not
/// be read back: fewer than two samples, a sample that is not finite, a unit that is
/// not SI, a channel called "time"; and on a file that cannot be written.
void WriteRecord(const std::filesystem::path& file, const Record& record,
                 RecordFormat format);

}  // namespace mjdiag
