#pragma once
// A measured file as the record of a machine.

#include <filesystem>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag {

/// Columns and units as [record] of the setup says. Times that are irregular, or at
/// nearly the control rate, are resampled to it, with a note: readings and references
/// smoothly, inputs as their `hold` says, commands of controllers as they are held.
/// InputError as ReadMeasuredFile.
MeasuredFile ReadMeasured(const Setup& setup, const std::filesystem::path& file);

}  // namespace mjdiag
