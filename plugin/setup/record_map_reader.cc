#include "mjdiag/plugin/setup/record_map_reader.h"

#include <optional>
#include <string>
#include <vector>

namespace mjdiag {
namespace {

constexpr int kHighestFilterOrder = 12;

ColumnSpec ReadColumn(const TomlTable& table, const std::string& channel,
                      const std::optional<std::string>& dimension) {
  ColumnSpec spec{channel, table.Text("column", channel), table.Text("unit", ""),
                  false};
  if (spec.unit.empty() || !dimension) return spec;
  const Unit unit = KnownUnit(table, "unit", spec.unit);
  if (unit.si != *dimension) {
    table.Fail("unit", "'" + spec.unit + "' does not convert to '" + *dimension + "'",
               "a unit of '" + channel + "'");
  }
  return spec;
}

CompareSetup::Derived ReadDerivedForce(const TomlTable& table, const Setup& setup) {
  CompareSetup::Derived force;
  force.name = table.name();
  force.channel =
      DeclaredName(table, "channel", "actuator channel",
                   NamesOf(setup.channels.actuators, &ActuatorSetup::channel));
  force.factor = table.Number("factor", kNonZero, 1.0);
  force.unit = SiUnit(table, "unit");
  return force;
}

}  // namespace

void ReadRecordMap(const TomlTable& root, Setup& setup, const ChannelUnits& channels) {
  const std::optional<TomlTable> record = root.FindTable("record");
  if (!record) return;
  std::vector<std::string> known;
  for (const auto& [channel, unit] : channels) known.push_back(channel);

  ColumnMap map;
  if (const auto time = record->FindTable("time")) {
    map.time = ReadColumn(*time, "time", "s");
  }
  for (const TomlTable& table : record->NamedTables("channels", "<channel>")) {
    const std::string channel = table.name();
    RequireDeclared(record->Table("channels"), channel, channel, "channel", known);
    ColumnSpec spec = ReadColumn(table, channel, channels.at(channel));
    spec.optional = table.Flag("optional", false);
    map.columns.push_back(spec);
  }
  if (map.columns.empty()) {
    record->Fail("channels", "is empty", "the column of a channel at least");
  }
  setup.record = map;
}

void ReadCompare(const TomlTable& root, Setup& setup, ChannelUnits& channels) {
  const std::optional<TomlTable> table = root.FindTable("compare");
  if (!table) return;
  CompareSetup& compare = setup.compare;
  compare.skip_samples = table->Integer("skip_samples", 0, 1'000'000'000, 0);
  if (const auto low_pass = table->FindTable("low_pass")) {
    compare.low_pass_order = low_pass->Integer("order", 1, kHighestFilterOrder);
    compare.low_pass_cutoff = low_pass->Number("cutoff", kPositive);
    RequireBelowNyquist(*low_pass, "cutoff", compare.low_pass_cutoff, setup);
  }
  for (const TomlTable& force : table->NamedTables("forces", "<name>")) {
    compare.forces.push_back(ReadDerivedForce(force, setup));
    DeclareChannel(force, force.name(), compare.forces.back().unit, channels);
  }
}

}  // namespace mjdiag
