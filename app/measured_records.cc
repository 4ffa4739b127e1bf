#include "app/measured_records.h"

#include <algorithm>
#include <filesystem>

#include "mjdiag/plugin/setup/record_manifest.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag::app {
namespace {

namespace fs = std::filesystem;

MeasuredRecord Load(const fs::path& file, const Machine& machine) {
  return {ReadRecord(file, machine.setup().record), machine, file.filename().string()};
}

void AddManifest(const MeasurementOptions& options, const MachineOptions& machine,
                 const Machine& nominal, Measurements& measurements) {
  for (const ManifestRecord& one : ReadRecordManifest(options.manifest, options.data)) {
    std::vector<std::string> overrides = machine.overrides;
    overrides.insert(overrides.end(), one.overrides.begin(), one.overrides.end());
    const Machine during = one.overrides.empty()
                               ? nominal
                               : nominal.WithSetup(ReadSetup(machine.setup, overrides));
    (one.fit ? measurements.fit : measurements.unseen)
        .push_back(Load(one.file, during));
  }
}

}  // namespace

void AddMeasurementOptions(CLI::App& command, MeasurementOptions& options) {
  command.add_option("--record", options.records,
                     "Measured record, CSV or MAT; may be given more than once");
  command.add_option(
      "--validation", options.validations,
      "Record of another motion, to which nothing is fitted; may be given "
      "more than once");
  CLI::Option* manifest =
      command.add_option("--records", options.manifest,
                         "File that lists records, with what the setup was set to in "
                         "each (docs/setup.md)");
  CLI::Option* data =
      command.add_option("--data", options.data, "Folder of the records of --records");
  manifest->needs(data);
  data->needs(manifest);
}

Measurements LoadMeasurements(const MeasurementOptions& options,
                              const MachineOptions& machine, const Machine& nominal) {
  Measurements measurements;
  if (!options.manifest.empty()) {
    AddManifest(options, machine, nominal, measurements);
  }
  for (const std::string& file : options.records) {
    measurements.fit.push_back(Load(file, nominal));
  }
  for (const std::string& file : options.validations) {
    measurements.unseen.push_back(Load(file, nominal));
  }
  if (measurements.fit.empty()) {
    throw InputError("--record", "is missing", "a record, or --records with --data");
  }
  return measurements;
}

std::string Names(const std::vector<MeasuredRecord>& records) {
  constexpr std::size_t kShown = 2;
  std::string names;
  for (std::size_t i = 0; i < std::min(kShown, records.size()); ++i) {
    names += (i == 0 ? "" : ", ") + records[i].name;
  }
  if (records.size() > kShown) {
    names += " and " + std::to_string(records.size() - kShown) + " more";
  }
  return names;
}

}  // namespace mjdiag::app
