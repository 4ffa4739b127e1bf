#pragma once
// How `discover` shows its answer: the tables for people and the files of the
// extended plant.

#include <string>

#include "app/subject.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag::app {

/// The answer and its tables.
std::string DiscoveryAsText(const Discovery& discovery);

/// Writes `<folder>/extended/plant.xml` and `setup.toml` if causes were found.
/// @return the path of the plant; empty without causes
std::string WriteExtendedPlant(const std::string& folder, const std::string& setup,
                               const Machine& machine, const Discovery& discovery);

/// Takes the extended plant of an earlier run out of the folder of one that has none, unless
/// it is the plant that was given.
void RemoveExtendedPlant(const std::string& folder, const std::string& setup);

}  // namespace mjdiag::app
