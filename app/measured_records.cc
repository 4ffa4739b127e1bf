#include "app/measured_records.h"

#include <algorithm>

#include "mjdiag/plugin/setup/record_manifest.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {

void AddMeasurementOptions(CLI::App& command, MeasurementOptions& options) {
  command.add_option(
      "--record", options.records,
      "Measured record: CSV, JSON, HDF5 or MAT; may be given more than once");
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

namespace {

std::vector<ManifestRecord> ListedRecords(const MeasurementOptions& options) {
  std::vector<ManifestRecord> records;
  if (!options.manifest.empty()) {
    records = ReadRecordManifest(options.manifest, options.data);
  }
  for (const std::string& file : options.records) records.push_back({file, true});
  for (const std::string& file : options.validations) records.push_back({file, false});
  if (std::ranges::none_of(records, &ManifestRecord::fit)) {
    throw InputError("--record", "is missing", "a record, or --records with --data");
  }
  return records;
}

}  // namespace

std::string FirstRecord(const MeasurementOptions& options) {
  const std::vector<ManifestRecord> records = ListedRecords(options);
  return std::ranges::find_if(records, &ManifestRecord::fit)->file.string();
}

Measurements LoadMeasurements(const MeasurementOptions& options,
                              const MachineOptions& machine, const Machine& nominal) {
  return ReadMeasurements(nominal, machine.setup, machine.overrides,
                          ListedRecords(options));
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
