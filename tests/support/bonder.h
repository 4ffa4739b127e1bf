#pragma once
// The wire bonder of mjcf/ab383.

#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag::test {

/// @param overrides  of its setup, "key.path=value"
inline Machine Bonder(const std::vector<std::string>& overrides = {}) {
  return Machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383", overrides));
}

}  // namespace mjdiag::test
