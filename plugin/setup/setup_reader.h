#pragma once
// Reading a setup file, section by section. ReadSetup of setup.h is what programs call;
// this is the same reading with a look at the keys it knows.

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// ReadSetup that also collects the pattern of every key it looked for, as
/// docs/setup.md writes them: "rates.control", "sensors.<channel>.unit".
Setup ReadSetup(const std::filesystem::path& where,
                const std::vector<std::string>& overrides,
                std::set<std::string>& known_keys);

}  // namespace mjdiag
