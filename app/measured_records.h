#pragma once
// The options that say which measured records a command works on.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "app/subject.h"
#include "mjdiag/discovery/measurements.h"

namespace mjdiag::app {

/// What the user asked for, as text.
struct MeasurementOptions {
  std::vector<std::string> records;
  std::vector<std::string> validations;
  std::string manifest;
  std::string data;
};

void AddMeasurementOptions(CLI::App& command, MeasurementOptions& options);

/// The first record that is fitted to; InputError as LoadMeasurements.
std::string FirstRecord(const MeasurementOptions& options);

/// @param nominal  the machine of the setup
/// InputError if there is nothing to fit to, and as ReadRecordManifest and ReadRecord.
Measurements LoadMeasurements(const MeasurementOptions& options,
                              const MachineOptions& machine, const Machine& nominal);

/// Names of the files, "a.csv, b.csv and 6 more".
std::string Names(const std::vector<MeasuredRecord>& records);

}  // namespace mjdiag::app
