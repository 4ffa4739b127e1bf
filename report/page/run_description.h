#pragma once
// How a run was made.

#include <string>
#include <utility>
#include <vector>

namespace mjdiag {

/// What it takes to do a run again.
struct RunDescription {
  std::string command;  ///< the exact command line
  std::string record;   ///< name of the measured file
  /// program -> version, for example {"mjdiag", "0.1.0"}
  std::vector<std::pair<std::string, std::string>> versions;
};

}  // namespace mjdiag
