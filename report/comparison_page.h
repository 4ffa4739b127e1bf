#pragma once
// The page of `mjdiag compare`: what the simulation gets wrong on a measured record.

#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/comparison.h"

namespace mjdiag {

/// What it takes to do a run again.
struct RunDescription {
  std::string command;  ///< the exact command line
  std::string record;   ///< name of the measured file
  /// program -> version, for example {"mjdiag", "0.1.0"}
  std::vector<std::pair<std::string, std::string>> versions;
};

/// The answer in one sentence, for example "The simulation misses q by 400 times its
/// noise floor (1.1 µm rms)."
std::string ComparisonVerdict(const Comparison& comparison);

/// The whole page. InputError if the plot library is not installed.
std::string ComparisonPage(const Comparison& comparison, const RunDescription& run);

}  // namespace mjdiag
