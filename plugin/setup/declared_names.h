#pragma once
// What a setup file declares and refers to: names, channels with their units, and what
// is said of those that are not there.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/plugin/setup/toml_table.h"
#include "mjdiag/signals/unit.h"

namespace mjdiag {

/// Channels that a record of this machine can have, with their SI unit; no unit: any.
using ChannelUnits = std::map<std::string, std::optional<std::string>>;

template <typename Element>
std::vector<std::string> NamesOf(const std::vector<Element>& elements,
                                 std::string Element::*name) {
  std::vector<std::string> names;
  names.reserve(elements.size());
  for (const Element& element : elements) names.push_back(element.*name);
  return names;
}

/// InputError at the key unless one of the declared names is wanted.
void RequireDeclared(const TomlTable& table, std::string_view key,
                     const std::string& wanted, const std::string& kind,
                     const std::vector<std::string>& declared);

/// Text that must be one of the declared names.
std::string DeclaredName(const TomlTable& table, std::string_view key,
                         const std::string& kind,
                         const std::vector<std::string>& declared);

/// InputError on a unit that ParseUnit does not know.
Unit KnownUnit(const TomlTable& table, std::string_view key, const std::string& text);

/// A unit in which mjdiag computes.
std::string SiUnit(const TomlTable& table, std::string_view key);

/// InputError if there is such a channel already.
void DeclareChannel(const TomlTable& table, const std::string& channel,
                    const std::optional<std::string>& unit, ChannelUnits& channels);

/// InputError on a frequency that the control rate does not resolve.
void RequireBelowNyquist(const TomlTable& table, std::string_view key, double frequency,
                         const Setup& setup);

}  // namespace mjdiag
