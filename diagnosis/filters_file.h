#pragma once
// filters.json: a finished diagnosis in a file, schema "mjdiag.filters/1". `mjdiag
// design` writes it; `diagnose` and `simulate --diagnose` read it, so that a diagnosis
// that was calibrated once runs anywhere, to the last bit.
//
// sample_time [s], outputs, inputs, offset, sensor_noise; faults; filters {gain,
// feedback, B, D}, residuals (how many of the outputs come first), rows (numerators of
// p^k); stride; disturbances; disturbance {filters, high_pass}; options; limits.

#include <filesystem>
#include <string>

#include "mjdiag/diagnosis/diagnosis_design.h"

namespace mjdiag {

/// The document as text; other members may be added to it.
std::string FiltersJson(const DiagnosisDesign& design);

/// Replaces the file. InputError if it cannot be written.
void WriteFilters(const std::filesystem::path& file, const DiagnosisDesign& design);

/// InputError with file and key: not JSON, another schema, a missing key, shapes that
/// do not fit.
DiagnosisDesign ReadFilters(const std::filesystem::path& file);

}  // namespace mjdiag
