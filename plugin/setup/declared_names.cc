#include "mjdiag/plugin/setup/declared_names.h"

#include <algorithm>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

std::string OneOf(const std::vector<std::string>& names) {
  return names.empty() ? "none, the setup declares none" : "one of " + Listed(names);
}

}  // namespace

void RequireDeclared(const TomlTable& table, std::string_view key,
                     const std::string& wanted, const std::string& kind,
                     const std::vector<std::string>& declared) {
  if (std::find(declared.begin(), declared.end(), wanted) != declared.end()) return;
  table.Fail(key, "there is no " + kind + " '" + wanted + "'", OneOf(declared));
}

std::string DeclaredName(const TomlTable& table, std::string_view key,
                         const std::string& kind,
                         const std::vector<std::string>& declared) {
  std::string wanted = table.Text(key);
  RequireDeclared(table, key, wanted, kind, declared);
  return wanted;
}

Unit KnownUnit(const TomlTable& table, std::string_view key, const std::string& text) {
  try {
    return ParseUnit(text);
  } catch (const InputError&) {
    table.Fail(key, "unknown unit '" + text + "'",
               R"(a unit such as "m", "um", "rad", "N m", "V" or "m/s^2")");
  }
}

std::string SiUnit(const TomlTable& table, std::string_view key) {
  const std::string text = table.Text(key);
  const Unit unit = KnownUnit(table, key, text);
  if (unit.factor != 1.0) {
    table.Fail(key, "'" + text + "' is no SI unit", "'" + unit.si + "'");
  }
  return unit.si;
}

void DeclareChannel(const TomlTable& table, const std::string& channel,
                    const std::optional<std::string>& unit, ChannelUnits& channels) {
  if (!channels.emplace(channel, unit).second) {
    table.Fail("the channel '" + channel + "' exists already",
               "names that differ from each other");
  }
}

void RequireBelowNyquist(const TomlTable& table, std::string_view key, double frequency,
                         const Setup& setup) {
  if (frequency >= 0.5 * setup.rates.control) {
    table.Fail(key, "a frequency is not below half the control rate",
               "frequencies in Hz below rates.control / 2");
  }
}

}  // namespace mjdiag
