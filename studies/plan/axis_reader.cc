#include "mjdiag/studies/plan/axis_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/studies/plan/run_machine.h"

namespace mjdiag {
namespace {

constexpr int kMostPoints = 1'000'000;

std::vector<std::string> FaultNames(const Machine& machine) {
  std::vector<std::string> names;
  for (const FaultParameter& parameter : FaultParameters(machine.plant())) {
    names.push_back(parameter.name);
  }
  for (const MultisineSetup& source : machine.setup().disturbances) {
    names.push_back(source.name);
  }
  return names;
}

PlanAxis AxisOf(const Setup& setup, const std::string& fault) {
  const bool disturbance = IsDisturbance(setup, fault);
  PlanAxis axis;
  axis.kind = disturbance ? AxisKind::kDisturbance : AxisKind::kFault;
  axis.name = fault;
  axis.unit = "1";
  axis.healthy = disturbance ? 0.0 : 1.0;
  return axis;
}

void ReadFault(const TomlTable& table, const Machine& machine, PlanAxis& axis) {
  axis = AxisOf(machine.setup(),
                DeclaredName(table, "fault", "fault parameter or disturbance",
                             FaultNames(machine)));
  const bool disturbance = axis.kind == AxisKind::kDisturbance;
  if (table.Has("appears")) {
    const double from = table.Number("appears", kNonNegative);
    const double to = table.Number("appears_until", kNonNegative, from);
    if (to < from) table.Fail("appears_until", "is before appears", "a later time");
    axis.appears = {from, to};
    axis.growth = table.Number("grows", kNonNegative, 0.0);
    if (axis.growth > 0.0 && disturbance) {
      table.Fail("grows", "'" + axis.name + "' is a disturbance, which appears at once",
                 "a fault parameter, or no growth");
    }
  }
}

void ReadEffect(const TomlTable& table, const AxisSurroundings& around,
                PlanAxis& axis) {
  axis.kind = AxisKind::kEffect;
  axis.effect = table.Text("effect");
  axis.parameter = table.Text("parameter");
  axis.healthy = table.Number("healthy", kAnyNumber, 0.0);
  if (around.plan.linear) {
    table.Fail("effect", "the linear plant has no effects",
               "linear = false, or faults");
  }
  const std::string at = axis.effect.substr(0, axis.effect.find(':'));
  axis.name = at + ":" + axis.parameter;
  const std::string kind = at.substr(0, at.find('@'));
  if (at.find('@') == at.npos) {
    table.Fail("effect", "names no site", "\"<effect>@<site>\"");
  }
  WithPlace(table, "effect", [&] {
    const Effect& effect = FindEffect(kind);
    const auto found =
        std::ranges::find(effect.parameters(), axis.parameter, &EffectParameter::name);
    if (found == effect.parameters().end()) {
      std::string known;
      for (const EffectParameter& parameter : effect.parameters()) {
        known += (known.empty() ? "" : ", ") + parameter.name;
      }
      throw InputError("parameter '" + axis.parameter + "'", kind + " has no such",
                       "one of " + known);
    }
    axis.unit =
        SiteUnit(around.machine.plant(), effect, at.substr(at.find('@') + 1), *found);
  });
}

void RequireAll(const TomlTable& table, const char* key, const char* what) {
  if (table.Text(key) == "all") return;
  table.Fail(key, "is another word", std::string("\"all\": ") + what);
}

/// The kind of an axis is the one of these keys that it has.
void ReadKind(const TomlTable& table, const AxisSurroundings& around, PlanAxis& axis) {
  constexpr std::array kKinds = {"fault", "effect", "key", "noise", "disturbance"};
  const auto given =
      std::ranges::count_if(kKinds, [&](const char* kind) { return table.Has(kind); });
  if (given != 1) {
    table.Fail(given == 0 ? "says nothing of what it moves" : "moves two things",
               "one of the keys fault, effect, key, noise and disturbance");
  }
  axis.unit = "1";
  if (table.Has("fault")) return ReadFault(table, around.machine, axis);
  if (table.Has("effect")) return ReadEffect(table, around, axis);
  if (table.Has("key")) {
    axis.kind = AxisKind::kKey;
    axis.name = table.Text("key");
    axis.healthy = 0.0;  // nothing is wrong at any value
    return;
  }
  if (table.Has("disturbance")) {
    axis.kind = AxisKind::kDisturbance;
    axis.healthy = 0.0;
    RequireAll(table, "disturbance", "every one of the setup, or fault for one");
    return;
  }
  axis.kind = AxisKind::kNoise;
  axis.name = "noise";
  RequireAll(table, "noise", "a factor of the noise of all sensors");
}

ValueRange ReadRange(const TomlTable& table) {
  return {table.Number("from", kAnyNumber), table.Number("to", kAnyNumber)};
}

void ReadValues(const TomlTable& table, PlanAxis& axis) {
  const bool listed = table.Has("values");
  const bool several = table.Has("ranges");
  const bool range = table.Has("from") || table.Has("to");
  if (listed + several + range != 1) {
    table.Fail(
        listed + several + range == 0 ? "has no values" : "has values in two ways",
        "values = [..], from and to, or ranges = [{ from = .., to = .. }, ..]");
  }
  if (listed) {
    axis.values = table.Numbers("values", kAnyNumber);
    return;
  }
  if (range) axis.ranges = {ReadRange(table)};
  for (const TomlTable& one : table.TableArray("ranges")) {
    axis.ranges.push_back(ReadRange(one));
  }
  const std::string scale = table.Text("scale", "linear");
  if (scale != "linear" && scale != "log") {
    table.Fail("scale", "is '" + scale + "'", R"("linear" or "log")");
  }
  axis.logarithmic = scale == "log";
  for (const auto& [from, to] : axis.ranges) {
    if (!axis.logarithmic || (from - axis.healthy) * (to - axis.healthy) > 0.0)
      continue;
    std::ostringstream healthy;
    healthy << axis.healthy;
    table.Fail("scale", "the range reaches the healthy value, " + healthy.str(),
               "both ends on one side of it, or scale = \"linear\"");
  }
  axis.points = table.Integer("points", 2, kMostPoints, 2);
}

/// Extremes, which are what a machine refuses if it refuses any.
std::vector<double> Extremes(const PlanAxis& axis) {
  std::vector<double> values = axis.values;
  for (const auto& [from, to] : axis.ranges) values.insert(values.end(), {from, to});
  return values;
}

void CheckValues(const TomlTable& table, const AxisSurroundings& around,
                 const PlanAxis& axis) {
  const char* key = table.Has("values") ? "values"
                    : table.Has("from") ? "from"
                                        : "ranges";
  const auto refuse = [&](double value, const char* expected) {
    std::ostringstream text;
    text << value;
    table.Fail(key, "is " + text.str(), expected);
  };
  for (const double value : Extremes(axis)) {
    if (axis.kind == AxisKind::kNoise && value < 0.0) refuse(value, "factors >= 0");
    if (axis.kind == AxisKind::kFault && axis.appears && value == 0.0) {
      refuse(value, "factors above 0 of a fault that appears");
    }
    WithPlace(table, key, [&] {
      if (axis.kind == AxisKind::kFault)
        around.machine.With({{{axis.name, value}}, {}});
      if (axis.kind == AxisKind::kKey) {
        MachineWithKeys(around.plan, around.machine, {{axis.name, value}});
      }
    });
  }
}

/// Of a fault, which is nearest to healthy in the first table, the ranges to where it is
/// farthest in the others.
std::vector<ValueRange> RangesTo(const Setup& setup, double healthy,
                                 const std::vector<std::string>& tables,
                                 const std::string& fault, double nearest) {
  std::vector<ValueRange> ranges;
  const double least = std::abs(nearest - healthy);
  for (std::size_t i = 1; i < tables.size(); ++i) {
    const auto& values = setup.Study(tables[i]).values;
    const auto found =
        std::ranges::find(values, fault, &std::pair<std::string, double>::first);
    if (found == values.end()) {
      throw InputError("studies." + tables[i], "lacks '" + fault + "'",
                       "the faults of " + tables.front());
    }
    const double away = found->second - healthy;
    if (least > 0.0 && std::abs(away) > least) {
      ranges.push_back({healthy + std::copysign(least, away), found->second});
    }
  }
  if (!ranges.empty()) return ranges;
  const std::vector<std::string> others(tables.begin() + 1, tables.end());
  throw InputError("studies." + tables.front() + "." + fault,
                   "leaves nothing to be drawn",
                   "a value between healthy and " + Listed(others, " or "));
}

/// Names in the order in which records have them.
std::vector<std::string> RecordChannels(const Machine& machine) {
  const Setup& setup = machine.setup();
  std::vector<std::string> names = ChannelsOf(setup.channels.sensors);
  for (const std::string& name : ChannelsOf(setup.channels.actuators)) {
    names.push_back(name);
  }
  for (const AxisSetup& axis : setup.control.axes) {
    for (const char* what :
         {"_ref", "_ref_velocity", "_ref_acceleration", "_ref_snap"}) {
      names.push_back(axis.name + what);
    }
  }
  return names;
}

std::vector<std::string> JointNames(const Machine& machine) {
  std::vector<std::string> names;
  for (int joint = 0; joint < machine.plant().njnt; ++joint) {
    names.push_back(ElementName(machine.plant(), mjOBJ_JOINT, joint));
  }
  return names;
}

/// An array of names, or ["all"].
std::vector<std::string> ReadNames(const TomlTable& table, const char* key,
                                   const std::string& kind,
                                   const std::vector<std::string>& known) {
  const std::vector<std::string> wanted = table.Texts(key, {});
  if (wanted == std::vector<std::string>{"all"}) return known;
  for (const std::string& name : wanted) {
    RequireDeclared(table, key, name, kind, known);
    if (std::ranges::count(wanted, name) > 1) {
      table.Fail(key, "names '" + name + "' twice", "every one once");
    }
  }
  return wanted;
}

}  // namespace

std::vector<PlanAxis> ReadAxis(const TomlTable& table, const AxisSurroundings& around) {
  PlanAxis axis;
  ReadKind(table, around, axis);
  ReadValues(table, axis);
  CheckValues(table, around, axis);
  if (!table.Has("disturbance")) return {axis};
  std::vector<PlanAxis> axes;
  for (const MultisineSetup& source : around.machine.setup().disturbances) {
    axes.push_back(axis);
    axes.back().name = source.name;
  }
  return axes;
}

std::vector<PlanAxis> ReadSizes(const TomlTable& table, const Machine& machine) {
  const std::vector<std::string> tables = table.Texts("sizes", {});
  std::vector<PlanAxis> axes;
  if (tables.empty()) return axes;
  WithPlace(table, "sizes", [&] {
    const Setup& setup = machine.setup();
    for (const auto& [fault, value] : setup.Study(tables.front()).values) {
      axes.push_back(AxisOf(setup, fault));
      PlanAxis& axis = axes.back();
      if (tables.size() == 1) {
        axis.values = {value};
      } else {
        axis.logarithmic = true;
        axis.points = 2;
        axis.ranges = RangesTo(setup, axis.healthy, tables, fault, value);
      }
      if (axis.kind == AxisKind::kDisturbance) continue;
      for (const double extreme : Extremes(axis))
        machine.With({{{fault, extreme}}, {}});
    }
  });
  return axes;
}

PlanKeep ReadKeep(const TomlTable& root, const Machine& machine) {
  PlanKeep keep;
  const TomlTable table = root.Table("keep");
  keep.channels = ReadNames(table, "records", "channel", RecordChannels(machine));
  keep.joints = ReadNames(table, "joints", "joint", JointNames(machine));
  keep.every = table.Integer("every", 1, kMostPoints, 1);
  const std::string precision = table.Text("precision", "double");
  if (precision != "double" && precision != "single") {
    table.Fail("precision", "is '" + precision + "'", R"("double" or "single")");
  }
  keep.single_precision = precision == "single";
  keep.residual = table.Flag("residual", false);
  keep.estimates = table.Flag("estimates", false);
  keep.verdicts = table.Flag("verdicts", false);
  keep.features = ReadNames(table, "features", "channel", RecordChannels(machine));
  constexpr int kShortest = 16;
  keep.segment = table.Integer("segment", kShortest, kMostPoints, keep.segment);
  if (!keep.Series() && !keep.Diagnoses() && keep.features.empty()) {
    table.Fail("nothing is kept",
               "some of records, joints, residual, estimates, verdicts and features");
  }
  return keep;
}

}  // namespace mjdiag
