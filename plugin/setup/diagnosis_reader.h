#pragma once
// The [diagnosis] section of a setup file.

#include "mjdiag/diagnosis/diagnosis_options.h"
#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/plugin/setup/toml_table.h"

namespace mjdiag {

/// Fault parameters and joints are checked when the diagnosis is designed.
/// @param setup  everything but the diagnosis
/// InputError with file, line and key.
DiagnosisOptions ReadDiagnosis(const TomlTable& table, const Setup& setup);

}  // namespace mjdiag
