#pragma once
// `discovery.json`: what a discovery found, for other programs.

#include <nlohmann/json.hpp>
#include <string>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// What discovery_fields.h describes.
/// @param extended_plant  path of its MJCF file; empty: none was written
nlohmann::json ToJson(const Discovery& discovery, const std::string& extended_plant);

}  // namespace mjdiag
