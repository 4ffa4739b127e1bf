#pragma once
// A measured file as the record of a machine.

#include <filesystem>
#include <map>
#include <string>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag {

/// What the setup knows of its sensors.
std::map<std::string, ReadingScale> ReadingsOf(const Setup& setup);

/// Columns and units as [record] of the setup says. Times that are irregular, or at
/// another rate than the control, are resampled to it, with a note: readings and references
/// smoothly, inputs as their `hold` says, commands of controllers as they are held. What
/// is missing or repeated counts as not measured. InputError as ReadMeasuredFile.
MeasuredFile ReadMeasured(const Setup& setup, const std::filesystem::path& file);

}  // namespace mjdiag
