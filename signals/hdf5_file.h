#pragma once
// Records in HDF5: every dataset of numbers is a column, of two dimensions one for each of
// its columns (column_name.h); in groups it is named by its path, "robot/q[0]". Along which
// dimension the samples are: the longer one, for MATLAB writes the other way round than
// NumPy. Its attribute `unit` or `units`, if it has one, is the unit.

#include <filesystem>
#include <memory>

#include "mjdiag/signals/record_source.h"

namespace mjdiag {

/// Whether the file's first bytes are HDF5's.
bool IsHdf5(const std::filesystem::path& file);

/// InputError if the file is cut off or damaged, holds no numbers, or mjdiag was built
/// without HDF5.
std::unique_ptr<RecordSource> OpenHdf5(const std::filesystem::path& file);

}  // namespace mjdiag
