#include "mjdiag/plugin/setup/setup_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/plugin/setup/diagnosis_reader.h"
#include "mjdiag/plugin/setup/record_map_reader.h"
#include "mjdiag/plugin/setup/toml_table.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/unit.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "mjdiag.setup/1";
constexpr double kHighestRate = 1e6;  // [Hz]
constexpr double kMostSamples = 1e8;  // of a trajectory
constexpr int kMostSubsteps = 1000;
constexpr int kMostComponents = 16;  // of an MJCF sensor

fs::path ExistingFile(const TomlTable& root, std::string_view key,
                      const fs::path& folder) {
  fs::path file = folder / root.Text(key);
  std::error_code ignored;  // such as a name that is too long
  if (!fs::is_regular_file(file, ignored)) {
    root.Fail(key, "there is no file " + file.string(), "a file beside the setup");
  }
  return file;
}

std::optional<fs::path> OptionalFile(const TomlTable& root, std::string_view key,
                                     const fs::path& folder) {
  if (!root.Has(key)) return std::nullopt;
  return ExistingFile(root, key, folder);
}

void ReadHead(const TomlTable& root, Setup& setup) {
  const std::string schema = root.Text("schema");
  if (schema != kSchema) {
    root.Fail("schema", "is '" + schema + "'", "'" + std::string(kSchema) + "'");
  }
  setup.name = root.Text("name");
  setup.channels.setup = setup.trajectories.setup = setup.name;
  setup.plant = ExistingFile(root, "plant", setup.folder);
  setup.analytic = OptionalFile(root, "analytic", setup.folder);
  setup.published = OptionalFile(root, "published", setup.folder);
  if (const auto file = OptionalFile(root, "calibration", setup.folder)) {
    setup.calibration = ReadCalibration(*file);
  }
}

void ReadRates(const TomlTable& root, Setup& setup) {
  const TomlTable rates = root.Table("rates");
  setup.rates.control = rates.Number("control", kPositive);
  if (setup.rates.control > kHighestRate) {
    rates.Fail("control", "is above 1e6 Hz", "a control rate in Hz");
  }
  setup.rates.substeps = rates.Integer("substeps", 1, kMostSubsteps, 1);
}

void ReadPhysics(const TomlTable& root, Setup& setup) {
  const std::optional<TomlTable> physics = root.FindTable("physics");
  if (!physics) return;
  setup.physics.gravity = physics->Flag("gravity", setup.physics.gravity);
  setup.physics.static_friction =
      physics->Flag("static_friction", setup.physics.static_friction);
}

/// Standard deviation of a sample; of band-limited white noise of a given power it is
/// sqrt(power * rate).
double NoiseSd(const TomlTable& sensor, double control_rate) {
  const double sd = sensor.Number("noise_sd", kNonNegative, 0.0);
  const double power = sensor.Number("noise_power", kNonNegative, 0.0);
  if (sensor.Has("noise_sd") && sensor.Has("noise_power")) {
    sensor.Fail("noise_power", "noise_sd is given as well", "one of them");
  }
  return sensor.Has("noise_power") ? std::sqrt(power * control_rate) : sd;
}

void ReadSensors(const TomlTable& root, Setup& setup, ChannelUnits& channels) {
  for (const TomlTable& table : root.NamedTables("sensors", "<channel>")) {
    SensorSetup sensor;
    sensor.channel = table.name();
    sensor.element = table.Text("element");
    sensor.component = table.Integer("component", 0, kMostComponents - 1, 0);
    sensor.unit = SiUnit(table, "unit");
    sensor.noise_sd = NoiseSd(table, setup.rates.control);
    sensor.resolution = table.Number("resolution", kNonNegative, 0.0);
    DeclareChannel(table, sensor.channel, sensor.unit, channels);
    setup.channels.sensors.push_back(sensor);
  }
  if (setup.channels.sensors.empty())
    root.Fail("sensors", "is empty", "a sensor at least");
}

Hold ReadHold(const TomlTable& actuator) {
  const std::string hold = actuator.Text("hold", "zero");
  if (hold == "linear") return Hold::kLinear;
  if (hold == "band_limited") return Hold::kBandLimited;
  if (hold != "zero") {
    actuator.Fail("hold", "is '" + hold + "'", R"("zero", "linear" or "band_limited")");
  }
  return Hold::kZero;
}

void ReadActuators(const TomlTable& root, Setup& setup, ChannelUnits& channels) {
  for (const TomlTable& table : root.NamedTables("actuators", "<channel>")) {
    ActuatorSetup actuator;
    actuator.channel = table.name();
    actuator.element = table.Text("element");
    actuator.unit = SiUnit(table, "unit");
    actuator.limit = table.Number("limit", kNonNegative, 0.0);
    actuator.hold = ReadHold(table);
    actuator.enabled_by = table.Text("enabled_by", "");
    DeclareChannel(table, actuator.channel, actuator.unit, channels);
    setup.channels.actuators.push_back(actuator);
  }
  // One switch may be that of several actuators.
  for (const std::string& channel : setup.channels.Switches()) {
    DeclareChannel(root.Table("actuators"), channel, "1", channels);
  }
  if (setup.channels.actuators.empty()) {
    root.Fail("actuators", "is empty", "an actuator at least");
  }
}

FeedforwardGains ReadFeedforward(const TomlTable& axis) {
  const std::optional<TomlTable> table = axis.FindTable("feedforward");
  if (!table) return {};
  return {table->Number("snap", kAnyNumber, 0.0),
          table->Number("acceleration", kAnyNumber, 0.0),
          table->Number("velocity", kAnyNumber, 0.0)};
}

std::optional<DiscreteCompensator> ReadFeedback(const TomlTable& axis) {
  const std::optional<TomlTable> table = axis.FindTable("feedback");
  if (!table) return std::nullopt;
  const DiscreteCompensator compensator{table->Numbers("numerator", kAnyNumber),
                                        table->Numbers("denominator", kAnyNumber)};
  if (compensator.denominator.front() == 0.0) {
    table->Fail("denominator", "begins with 0", "the coefficient of its highest power");
  }
  if (compensator.numerator.size() > compensator.denominator.size()) {
    table->Fail("numerator", "is longer than the denominator", "a proper compensator");
  }
  return compensator;
}

std::optional<NestedLoops> ReadNestedLoops(const TomlTable& axis) {
  const std::optional<TomlTable> table = axis.FindTable("nested");
  if (!table) return std::nullopt;
  return NestedLoops{table->Number("position_gain", kAnyNumber),
                     table->Number("velocity_gain", kAnyNumber),
                     table->Number("saturation", kNonNegative, 0.0)};
}

MoveLimits ReadLimits(const TomlTable& table) {
  return {table.Number("velocity", kPositive), table.Number("acceleration", kPositive),
          table.Number("jerk", kPositive), table.Number("snap", kPositive)};
}

AxisSetup ReadAxis(const TomlTable& table, const Setup& setup) {
  AxisSetup axis;
  axis.name = table.name();
  axis.sensor = DeclaredName(table, "sensor", "sensor channel",
                             NamesOf(setup.channels.sensors, &SensorSetup::channel));
  axis.actuator =
      DeclaredName(table, "actuator", "actuator channel",
                   NamesOf(setup.channels.actuators, &ActuatorSetup::channel));
  for (const AxisSetup& other : setup.control.axes) {
    if (other.actuator == axis.actuator) {
      table.Fail("actuator", "'" + axis.actuator + "' drives axis '" + other.name + "'",
                 "an actuator for each axis");
    }
  }
  axis.drive_gain = table.Number("drive_gain", kNonZero, 1.0);
  axis.feedforward = ReadFeedforward(table);
  axis.feedback = ReadFeedback(table);
  axis.nested = ReadNestedLoops(table);
  if (axis.feedback.has_value() == axis.nested.has_value()) {
    table.Fail(axis.nested ? "has two controllers" : "has no controller",
               "either feedback or nested");
  }
  if (axis.nested && table.Has("feedforward")) {
    table.Fail("feedforward", "does not go with nested loops", "feedback, or no key");
  }
  if (table.Has("known_disturbance")) {
    axis.known_disturbance = table.Text("known_disturbance");
  }
  if (const auto limits = table.FindTable("limits")) axis.limits = ReadLimits(*limits);
  return axis;
}

void ReadAxes(const TomlTable& root, Setup& setup, ChannelUnits& channels) {
  for (const TomlTable& table : root.NamedTables("axes", "<axis>")) {
    const AxisSetup axis = ReadAxis(table, setup);
    const std::string unit = setup.channels.Sensor(axis.sensor).unit;
    const std::string reference = axis.name + "_ref";
    DeclareChannel(table, reference, unit, channels);
    DeclareChannel(table, reference + "_velocity", ParseUnit(unit + "/s").si, channels);
    DeclareChannel(table, reference + "_acceleration", ParseUnit(unit + "/s^2").si,
                   channels);
    DeclareChannel(table, reference + "_snap", ParseUnit(unit + "/s^4").si, channels);
    if (!axis.known_disturbance.empty()) {
      DeclareChannel(table, axis.known_disturbance, std::nullopt, channels);
    }
    setup.control.axes.push_back(axis);
  }
}

void ReadDisturbances(const TomlTable& root, Setup& setup) {
  for (const TomlTable& table : root.NamedTables("disturbances", "<disturbance>")) {
    MultisineSetup multisine;
    multisine.name = table.name();
    multisine.frequencies = table.Numbers("frequencies", kPositive);
    for (const double frequency : multisine.frequencies) {
      RequireBelowNyquist(table, "frequencies", frequency, setup);
    }
    for (const TomlTable& entry : table.NamedTables("amplitude", "<actuator>")) {
      RequireDeclared(table.Table("amplitude"), entry.name(), entry.name(),
                      "actuator channel",
                      NamesOf(setup.channels.actuators, &ActuatorSetup::channel));
      multisine.amplitude[entry.name()] =
          entry.Number("ratio", kShare) * entry.Number("maximum", kPositive);
    }
    if (multisine.amplitude.empty()) {
      table.Fail("amplitude", "is empty", "ratio and maximum of an actuator channel");
    }
    setup.disturbances.push_back(multisine);
  }
}

Move ReadMove(const TomlTable& table, const std::vector<std::string>& axes,
              const Trajectory& trajectory) {
  Move move;
  move.at = table.Number("at", kNonNegative);
  const TomlTable by = table.Table("by");
  for (const auto& [axis, distance] : table.NamedNumbers("by", "<axis>", kNonZero)) {
    RequireDeclared(by, axis, axis, "axis", axes);
    if (!trajectory.limits.contains(axis)) {
      by.Fail(axis, "the axis has no limits", "[axes." + axis + ".limits]");
    }
    move.by[axis] = distance;
  }
  if (move.by.empty()) table.Fail("by", "is empty", "a distance for an axis");
  return move;
}

ReferenceTone ReadTone(const TomlTable& table, const std::vector<std::string>& axes) {
  ReferenceTone tone;
  tone.axis = DeclaredName(table, "axis", "axis", axes);
  tone.frequency = table.Number("frequency", kPositive);
  tone.amplitude = table.Number("amplitude", kNonZero);
  tone.phase = table.Number("phase", kAnyNumber, 0.0);
  return tone;
}

Trajectory ReadTrajectory(const TomlTable& table, const Setup& setup) {
  const std::vector<std::string> axes = NamesOf(setup.control.axes, &AxisSetup::name);
  Trajectory trajectory;
  trajectory.name = table.name();
  trajectory.duration = table.Number("duration", kPositive);
  if (trajectory.duration * setup.rates.control > kMostSamples) {
    table.Fail("duration", "is more than 1e8 control ticks", "seconds");
  }
  trajectory.period = table.Number("period", kNonNegative, 0.0);
  for (const AxisSetup& axis : setup.control.axes) {
    if (axis.limits.snap > 0.0) trajectory.limits[axis.name] = axis.limits;
  }
  for (const TomlTable& limits : table.NamedTables("limits", "<axis>")) {
    RequireDeclared(table.Table("limits"), limits.name(), limits.name(), "axis", axes);
    trajectory.limits[limits.name()] = ReadLimits(limits);
  }
  for (const TomlTable& move : table.TableArray("moves")) {
    trajectory.moves.push_back(ReadMove(move, axes, trajectory));
  }
  for (const TomlTable& tone : table.TableArray("tones")) {
    trajectory.tones.push_back(ReadTone(tone, axes));
    if (trajectory.tones.back().frequency >= 0.5 * setup.rates.control) {
      tone.Fail("frequency", "is not below half of the control rate", "a lower one");
    }
  }
  if (!trajectory.tones.empty()) {
    trajectory.ramp = table.Number("ramp", kPositive, 0.1 * trajectory.duration);
    if (2.0 * trajectory.ramp > trajectory.duration) {
      table.Fail("ramp", "is longer than half of the duration", "a shorter one");
    }
  }
  if (trajectory.moves.empty() && trajectory.tones.empty()) {
    table.Fail("moves", "is empty", "a move at least");
  }
  return trajectory;
}

void ReadTrajectories(const TomlTable& root, Setup& setup) {
  for (const TomlTable& table : root.NamedTables("trajectories", "<trajectory>")) {
    setup.trajectories.all.push_back(ReadTrajectory(table, setup));
  }
  if (root.Has("default_trajectory")) {
    setup.trajectories.fallback =
        DeclaredName(root, "default_trajectory", "trajectory",
                     NamesOf(setup.trajectories.all, &Trajectory::name));
  } else if (!setup.trajectories.all.empty()) {
    setup.trajectories.fallback = setup.trajectories.all.front().name;
  }
}

/// Faults are checked against the plant when a study runs.
void ReadStudies(const TomlTable& root, Setup& setup) {
  for (const TomlTable& table : root.NamedTables("studies", "<study>")) {
    setup.studies.push_back({table.name(), table.AllNumbers("<fault>", kNonNegative)});
  }
}

}  // namespace

Setup ReadSetup(const fs::path& where, const std::vector<std::string>& overrides,
                std::set<std::string>& known_keys) {
  const fs::path file = FindSetupFile(where);
  const TomlDocument document(file, overrides);
  const TomlTable root = document.Root();
  Setup setup;
  setup.folder = file.parent_path();
  ChannelUnits channels;
  ReadHead(root, setup);
  ReadRates(root, setup);
  ReadPhysics(root, setup);
  ReadSensors(root, setup, channels);
  ReadActuators(root, setup, channels);
  ReadAxes(root, setup, channels);
  ReadDisturbances(root, setup);
  ReadTrajectories(root, setup);
  ReadRecordMap(root, setup, channels);
  ReadCompare(root, setup, channels);
  if (const auto diagnosis = root.FindTable("diagnosis")) {
    setup.diagnosis = ReadDiagnosis(*diagnosis, setup);
  }
  ReadStudies(root, setup);
  document.RefuseUnknownKeys();
  known_keys.insert(document.known_keys().begin(), document.known_keys().end());
  return setup;
}

}  // namespace mjdiag
