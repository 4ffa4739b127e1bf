#pragma once
// What a discovery works on: measured records of one machine, those that fits see and
// those that they do not.

#include <filesystem>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/plugin/setup/record_manifest.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

struct MeasuredRecord {
  Record record;
  /// The machine as it was during the record: controllers with other gains, for example.
  /// Its rates and its channels are those of all records.
  Machine machine;
  std::string name{};                ///< of its file
  std::vector<std::string> notes{};  ///< of how the file became the record
  bool own_plant = false;            ///< loaded otherwise than the others
};

struct Measurements {
  std::vector<MeasuredRecord> fit;     ///< at least one
  std::vector<MeasuredRecord> unseen;  ///< nothing is fitted to them

  bool Several() const { return fit.size() + unseen.size() > 1; }
};

/// Of a list of records: what each of them sets comes behind `overrides` of the setup.
/// InputError as ReadSetup and ReadRecord, and on a plant of its own with other joints,
/// actuators or sensors.
Measurements ReadMeasurements(const Machine& nominal,
                              const std::filesystem::path& setup,
                              const std::vector<std::string>& overrides,
                              const std::vector<ManifestRecord>& records);

/// One record of a machine, and another that nothing is fitted to, or null. What of them
/// was not measured is marked (measured_columns.h).
Measurements MeasurementsOf(const Machine& machine, const Record& measured,
                            const Record* unseen);

/// All of them in one run. InputError as ToMeasuredRun.
MeasuredRun RunOf(const std::vector<MeasuredRecord>& records);

}  // namespace mjdiag
