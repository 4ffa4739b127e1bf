#pragma once
// [record] and [compare] of a setup: how a measured file becomes a Record, and how its
// figures are computed.

#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/plugin/setup/toml_table.h"

namespace mjdiag {

/// @param channels  all that the setup has declared
void ReadRecordMap(const TomlTable& root, Setup& setup, const ChannelUnits& channels);
/// @param channels  derived forces are declared in it
void ReadCompare(const TomlTable& root, Setup& setup, ChannelUnits& channels);

}  // namespace mjdiag
