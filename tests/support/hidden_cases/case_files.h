#pragma once
// Cases as files: a folder that is a setup (setup.toml, plant.xml) with two records of one
// machine, record.csv to explain and unseen.csv of another motion, and truth.json.

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"
#include "support/hidden_cases/hidden_case.h"

namespace mjdiag::test {

/// Numbers of a plant by their names, and by what the machine's are larger.
using NamedFactors = std::vector<std::pair<std::string, double>>;

struct CaseTruth {
  const HiddenCase& hidden;
  std::uint64_t seed = 1;
  std::vector<TrueCause> causes = {};
  /// The machine's numbers over those of the plant that is given.
  NamedFactors numbers = {};
};

/// The setup of a machine as somebody has it who does not know its numbers well.
/// @param machine  as it is
/// @param setup    its folder
void WriteGivenSetup(const std::filesystem::path& folder,
                     const std::filesystem::path& setup, const Machine& machine,
                     const NamedFactors& numbers);

/// @param machine  the machine that was measured, without what is hidden
void WriteCase(const std::filesystem::path& folder, const CaseTruth& truth,
               const Machine& machine, const Record& record, const Record& unseen);

}  // namespace mjdiag::test
