#pragma once
// Which measured records belong together, and what was set differently in each. In TOML,
//
//   [[record]]
//   file = "slow_kp100.csv"     # in the folder of the data
//   role = "fit"                # or "validation": nothing is fitted to it
//   set = { "axes.q.drive_gain" = 0.2 }   # keys of the setup, for this record
//   numbers = { "mass@load" = 2.5 }       # of the plant, in SI units: another load
//   plant = "with_2kg.xml"      # or another one, beside the setup's own plant
//
// What may be set is what does not change the plant: keys under axes, record and compare.
// Another plant has the joints, sensors and actuators of the setup's own.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace mjdiag {

struct ManifestRecord {
  std::filesystem::path file;
  bool fit = true;
  std::vector<std::string> overrides{};  ///< "key.path=value", for ReadSetup
  std::string plant{};  ///< its MJCF, relative to the setup; empty: that of the setup
  /// Numbers of that plant by their names (FindModelParameter), in SI units.
  std::vector<std::pair<std::string, double>> numbers{};
};

/// @param folder  of the records
/// InputError on what is malformed, an unknown key or role, a file named twice, and a
/// manifest without a record to fit.
std::vector<ManifestRecord> ReadRecordManifest(const std::filesystem::path& manifest,
                                               const std::filesystem::path& folder);

}  // namespace mjdiag
