#pragma once
// Changes of a machine, effects written as on the command line.

#include <string>
#include <vector>

#include "mjdiag/plugin/effects/changes.h"

namespace mjdiag::test {

inline Changes With(const std::vector<std::string>& effects,
                    const std::vector<Fault>& faults = {}) {
  Changes changes{faults, {}};
  for (const std::string& effect : effects) {
    changes.effects.push_back(ParseEffect(effect));
  }
  return changes;
}

}  // namespace mjdiag::test
