#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/error.h"
#include "plugin/setup/setup_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using SetupErrors = SetupFile;

TEST_F(SetupErrors, RefusesBadOverridesByTheirText) {
  EXPECT_EQ(
      Message({"rates.substeps=0"}),
      "override 'rates.substeps=0': rates.substeps: is 0; expected an integer from "
      "1 to 1000");
  EXPECT_EQ(Message({"rates.subtseps=2"}),
            "override 'rates.subtseps=2': rates.subtseps: unknown key; expected one of "
            "control, substeps");
  EXPECT_THAT(Message({"rates.substeps"}), StartsWith("override 'rates.substeps': "));
  EXPECT_THAT(Message({""}), StartsWith("override '': is empty"));
}

TEST_F(SetupErrors, RefusesAnUnknownHoldAndASwitchThatIsAnotherChannel) {
  EXPECT_THAT(Message({R"(actuators.u.hold="cubic")"}),
              HasSubstr(R"(is 'cubic'; expected "zero", "linear" or "band_limited")"));
  EXPECT_THAT(Message({R"(actuators.u.enabled_by="q")"}),
              HasSubstr("the channel 'q' exists already"));
}

TEST_F(SetupErrors, RefusesAMissingFile) {
  fs::remove(folder_ / "setup.toml");
  EXPECT_THAT(Message({}), HasSubstr((folder_ / "setup.toml").string()));
}

TEST_F(SetupErrors, RefusesMalformedToml) {
  EXPECT_THAT(MessageWith("control = 1000.0", "control = 1000.0.0"),
              AllOf(StartsWith((folder_ / "setup.toml").string() + ":8: "),
                    EndsWith("; expected TOML")));
  EXPECT_THAT(MessageWith("[rates]", "[rates"),
              StartsWith((folder_ / "setup.toml").string() + ":7: "));
  EXPECT_THAT(MessageWith("limit = 50.0", "unit = \"N\""),
              StartsWith((folder_ / "setup.toml").string() + ":26: "));
}

TEST_F(SetupErrors, RefusesAnEmptyFile) {
  Write("");
  EXPECT_THAT(Message({}), HasSubstr("schema: is missing"));
}

/// A change to the full setup and the line that answers it.
struct BadSetup {
  const char* from;
  const char* to;
  int line;
  const char* message;
};

TEST_F(SetupErrors, RefusesBadValuesInOneLine) {
  const std::vector<BadSetup> cases = {
      // unknown keys
      {"substeps = 4", "subtseps = 4", 9,
       "rates.subtseps: unknown key; expected one of control, substeps"},
      {"static_friction = false", "friction = false", 12,
       "physics.friction: unknown key; expected one of gravity, static_friction"},
      {"limit = 50.0", "limits = 50.0", 26,
       "actuators.u.limits: unknown key; expected one of element, enabled_by, hold, "
       "limit, "
       "unit"},
      {"velocity = 0.5 }\nfeedback", "speed = 0.5 }\nfeedback", 35,
       "axes.s.feedforward.speed: unknown key; expected one of acceleration, snap, "
       "velocity"},
      {"by = { s = 0.02 }", "by = { s = 0.02 }, to = 1", 54,
       "trajectories.slow.moves[0].to: unknown key; expected one of at, by"},
      {"[compare.forces]", "[comparison]\n[compare.forces]", 66,
       "comparison: unknown key; expected one of actuators, analytic, axes, "
       "calibration, compare, default_trajectory, diagnosis, disturbances, name, "
       "physics, plant, published, rates, record, schema, sensors, studies, "
       "trajectories"},
      // missing keys and wrong types
      {"control = 1000.0", "", 7, "rates.control: is missing; expected a number > 0"},
      {"control = 1000.0", "control = \"fast\"", 8,
       "rates.control: is text; expected a number > 0"},
      {"substeps = 4", "substeps = 4.5", 9,
       "rates.substeps: is a number; expected an integer from 1 to 1000"},
      {"gravity = false", "gravity = 0", 11,
       "physics.gravity: is an integer; expected true or false"},
      {"name = \"stage\"", "name = 3", 2,
       "name: is an integer; expected text in quotes"},
      {"name = \"stage\"", "name = \"\"", 2, "name: is empty; expected text in quotes"},
      {"element = \"encoder\"", "", 13,
       "sensors.q.element: is missing; expected text in quotes"},
      {"numerator = [3, -2.5]", "numerator = 3", 36,
       "axes.s.feedback.numerator: is an integer; expected an array, each a number"},
      {"numerator = [3, -2.5]", "numerator = []", 36,
       "axes.s.feedback.numerator: is empty; expected an array, each a number"},
      {"numerator = [3, -2.5]", "numerator = [3, \"x\"]", 36,
       "axes.s.feedback.numerator[1]: is text; expected a number"},
      {"limits = { velocity = 0.5,", "limits = { ", 37,
       "axes.s.limits.velocity: is missing; expected a number > 0"},
      {"moves = [{ at = 0.5, by = { s = 0.02 } }]", "moves = 3", 54,
       "trajectories.slow.moves: is an integer; expected an array of tables"},
      {"moves = [{ at = 0.5, by = { s = 0.02 } }]", "moves = [3]", 54,
       "trajectories.slow.moves[0]: is an integer; expected a table"},
      {"[physics]\ngravity = false\nstatic_friction = false", "physics = 1", 10,
       "rates.physics: unknown key; expected one of control, substeps"},
      // out of range
      {"schema = \"mjdiag.setup/1\"", "schema = \"mjdiag.setup/2\"", 1,
       "schema: is 'mjdiag.setup/2'; expected 'mjdiag.setup/1'"},
      {"control = 1000.0", "control = -1.0", 8,
       "rates.control: is -1; expected a number > 0"},
      {"control = 1000.0", "control = inf", 8,
       "rates.control: is inf; expected a number > 0"},
      {"control = 1000.0", "control = 2e6", 8,
       "rates.control: is above 1e6 Hz; expected a control rate in Hz"},
      {"substeps = 4", "substeps = 0", 9,
       "rates.substeps: is 0; expected an integer from 1 to 1000"},
      {"component = 1", "component = -1", 15,
       "sensors.q.component: is -1; expected an integer from 0 to 15"},
      {"noise_power = 4e-19", "noise_power = -4e-19", 17,
       "sensors.q.noise_power: is -4e-19; expected a number >= 0"},
      {"noise_power = 4e-19", "noise_power = 4e-19\nnoise_sd = 1e-9", 17,
       "sensors.q.noise_power: noise_sd is given as well; expected one of them"},
      {"resolution = 1e-9", "resolution = nan", 18,
       "sensors.q.resolution: is nan; expected a number >= 0"},
      {"limit = 50.0", "limit = -1", 26,
       "actuators.u.limit: is -1; expected a number >= 0"},
      {"drive_gain = 20.5", "drive_gain = 0", 33,
       "axes.s.drive_gain: is 0; expected a number other than 0"},
      {"drive_gain = 20.5", "drive_gain = true", 33,
       "axes.s.drive_gain: is a boolean; expected a number other than 0"},
      {"jerk = 2000.0", "jerk = 0", 37,
       "axes.s.limits.jerk: is 0; expected a number > 0"},
      {"denominator = [1.0, -0.5]", "denominator = [0.0, -0.5]", 36,
       "axes.s.feedback.denominator: begins with 0; expected the coefficient of its "
       "highest power"},
      {"denominator = [1.0, -0.5]", "denominator = [1.0]", 36,
       "axes.s.feedback.numerator: is longer than the denominator; expected a proper "
       "compensator"},
      {"saturation = 10.0", "saturation = -10.0", 41,
       "axes.r.nested.saturation: is -10; expected a number >= 0"},
      {"frequencies = [50.0, 150.0]", "frequencies = [50.0, 500.0]", 43,
       "disturbances.hum.frequencies: a frequency is not below half the control rate; "
       "expected frequencies in Hz below rates.control / 2"},
      {"frequencies = [50.0, 150.0]", "frequencies = [0.0]", 43,
       "disturbances.hum.frequencies[0]: is 0; expected a number > 0"},
      {"ratio = 0.01", "ratio = 1.01", 44,
       "disturbances.hum.amplitude.u.ratio: is 1.01; expected a number > 0 and <= 1"},
      {"duration = 2.0", "duration = 0", 46,
       "trajectories.fast.duration: is 0; expected a number > 0"},
      {"duration = 2.0", "duration = 1e6", 46,
       "trajectories.fast.duration: is more than 1e8 control ticks; expected seconds"},
      {"s = 0.02", "s = 0", 54,
       "trajectories.slow.moves[0].by.s: is 0; expected a number other than 0"},
      {"at = 0.5", "at = -0.5", 54,
       "trajectories.slow.moves[0].at: is -0.5; expected a number >= 0"},
      {"by = { s = 0.02 }", "by = {}", 54,
       "trajectories.slow.moves[0].by: is empty; expected a distance for an axis"},
      {"moves = [{ at = 0.5, by = { s = 0.02 } }]", "", 52,
       "trajectories.slow.moves: is empty; expected a move at least"},
      {"skip_samples = 49", "skip_samples = -1", 64,
       "compare.skip_samples: is -1; expected an integer from 0 to 1000000000"},
      {"cutoff = 100.0", "cutoff = 500.0", 65,
       "compare.low_pass.cutoff: a frequency is not below half the control rate; "
       "expected frequencies in Hz below rates.control / 2"},
      {"order = 4", "order = 0", 65,
       "compare.low_pass.order: is 0; expected an integer from 1 to 12"},
      // units
      {"unit = \"m\"", "unit = \"furlong\"", 16,
       "sensors.q.unit: unknown unit 'furlong'; expected a unit such as \"m\", \"um\", "
       "\"rad\", \"N m\", \"V\" or \"m/s^2\""},
      {"unit = \"m\"", "unit = \"mm\"", 16,
       "sensors.q.unit: 'mm' is no SI unit; expected 'm'"},
      {"unit = \"um\"", "unit = \"N\"", 58,
       "record.channels.s_ref.unit: 'N' does not convert to 'm'; expected a unit of "
       "'s_ref'"},
      {"unit = \"mm/s^2\"", "unit = \"mm/s\"", 61,
       "record.channels.s_ref_acceleration.unit: 'mm/s' does not convert to 'm/s^2'; "
       "expected a unit of 's_ref_acceleration'"},
      {"unit = \"ms\"", "unit = \"mm\"", 56,
       "record.time.unit: 'mm' does not convert to 's'; expected a unit of 'time'"},
      {"factor = 35.15, unit = \"N\"", "factor = 35.15, unit = \"kN\"", 67,
       "compare.forces.force.unit: 'kN' is no SI unit; expected 'N'"},
      // names
      {"sensor = \"q\"", "sensor = \"p\"", 31,
       "axes.s.sensor: there is no sensor channel 'p'; expected one of q, a"},
      {"actuator = \"u\"", "actuator = \"motor\"", 32,
       "axes.s.actuator: there is no actuator channel 'motor'; expected one of u, t"},
      {"actuator = \"t\"", "actuator = \"u\"", 40,
       "axes.r.actuator: 'u' drives axis 's'; expected an actuator for each axis"},
      {"amplitude = { u =", "amplitude = { q =", 44,
       "disturbances.hum.amplitude.q: there is no actuator channel 'q'; expected one "
       "of u, t"},
      {"amplitude = { u = { ratio = 0.01, maximum = 450.0 } }", "", 42,
       "disturbances.hum.amplitude: is empty; expected ratio and maximum of an "
       "actuator channel"},
      {"by = { s = 0.02 }", "by = { z = 0.02 }", 54,
       "trajectories.slow.moves[0].by.z: there is no axis 'z'; expected one of s, r"},
      {"by = { s = 0.02 }", "by = { r = 0.02 }", 54,
       "trajectories.slow.moves[0].by.r: the axis has no limits; expected "
       "[axes.r.limits]"},
      {"r = { velocity = 2.0", "w = { velocity = 2.0", 51,
       "trajectories.fast.limits.w: there is no axis 'w'; expected one of s, r"},
      {"default_trajectory = \"slow\"", "default_trajectory = \"swift\"", 6,
       "default_trajectory: there is no trajectory 'swift'; expected one of fast, "
       "slow"},
      {"q = { column", "position = { column", 59,
       "record.channels.position: there is no channel 'position'; expected one of a, "
       "pulse, q, r_ref, r_ref_acceleration, r_ref_snap, r_ref_velocity, s_ref, "
       "s_ref_acceleration, s_ref_snap, s_ref_velocity, t, u"},
      {"channel = \"u\"", "channel = \"q\"", 67,
       "compare.forces.force.channel: there is no actuator channel 'q'; expected one "
       "of u, t"},
      {"[actuators.t]", "[actuators.q]", 27,
       "actuators.q: the channel 'q' exists already; expected names that differ from "
       "each other"},
      {"known_disturbance = \"pulse\"", "known_disturbance = \"u\"", 30,
       "axes.s: the channel 'u' exists already; expected names that differ from each "
       "other"},
      {"[sensors.a]", "[sensors.\"a b\"]", 19,
       "sensors.a b: is not a name; expected letters, digits and _, beginning with a "
       "letter"},
      // controllers
      {"feedback = { numerator = [3, -2.5], denominator = [1.0, -0.5] }", "", 30,
       "axes.s: has no controller; expected either feedback or nested"},
      {"nested = {", "feedback = { numerator = [1], denominator = [1] }\nnested = {",
       38, "axes.r: has two controllers; expected either feedback or nested"},
      {"nested = {", "feedforward = { velocity = 1 }\nnested = {", 41,
       "axes.r.feedforward: does not go with nested loops; expected feedback, or no "
       "key"},
  };
  for (const BadSetup& bad : cases) {
    EXPECT_EQ(MessageWith(bad.from, bad.to), At(bad.line, bad.message))
        << bad.from << " -> " << bad.to;
  }
}

TEST_F(SetupErrors, RefusesABadDiagnosisInOneLine) {
  const std::vector<BadSetup> cases = {
      // unknown keys and wrong types
      {"degree = 3", "degre = 3", 69,
       "diagnosis.degre: unknown key; expected one of cutoff, degree, disturbance, "
       "estimation, order, robust, thresholds, unknown_forces"},
      {"margin = 3.0", "alpha = 3.0", 74,
       "diagnosis.thresholds.alpha: unknown key; expected one of false_alarms, "
       "integral_window, margin, trajectories"},
      {"horizon = 1.5", "window = 1.5", 81,
       "diagnosis.estimation.window: unknown key; expected one of forgetting, horizon, "
       "magnitudes, rows, sampling"},
      {"segment = 1024", "segments = 4", 88,
       "diagnosis.disturbance.segments: unknown key; expected one of cutoff, "
       "high_pass, order, peak_margin, segment, tone_false_alarm, total_margin"},
      {"high_pass = { order = 2,", "high_pass = { degree = 2,", 87,
       "diagnosis.disturbance.high_pass.degree: unknown key; expected one of cutoff, "
       "order"},
      {"runs = 12", "seeds = 12", 96,
       "diagnosis.robust.seeds: unknown key; expected one of cutoff, degree, order, "
       "runs"},
      {"[diagnosis.robust]", "[diagnosis.sturdy]", 92,
       "diagnosis.sturdy: unknown key; expected one of cutoff, degree, disturbance, "
       "estimation, order, robust, thresholds, unknown_forces"},
      {"degree = 3", "degree = 3.0", 69,
       "diagnosis.degree: is a number; expected an integer from 1 to 40"},
      {R"(unknown_forces = ["slide", "hinge"])", "unknown_forces = \"slide\"", 72,
       "diagnosis.unknown_forces: is text; expected an array of texts"},
      {R"(unknown_forces = ["slide", "hinge"])", "unknown_forces = [1]", 72,
       "diagnosis.unknown_forces[0]: is an integer; expected a text"},
      {"magnitudes = { zeta = 0.02, beta = 0.03 }", "magnitudes = 0.02", 83,
       "diagnosis.estimation.magnitudes: is a number; expected a table"},
      // out of range
      {"degree = 3", "degree = 0", 69,
       "diagnosis.degree: is 0; expected an integer from 1 to 40"},
      {"order = 5", "order = 21", 70,
       "diagnosis.order: is 21; expected an integer from 1 to 20"},
      {"cutoff = 60.0", "cutoff = 0.0", 71,
       "diagnosis.cutoff: is 0; expected a number > 0"},
      {"cutoff = 60.0", "cutoff = 500.0", 71,
       "diagnosis.cutoff: is 500.000000 Hz; expected less than half the control rate"},
      {"margin = 3.0", "margin = 0.9", 74,
       "diagnosis.thresholds.margin: is 0.9; expected a number >= 1"},
      {"false_alarms = 0.01", "false_alarms = 1", 75,
       "diagnosis.thresholds.false_alarms: is 1; expected a number >= 0 and < 1"},
      {"integral_window = 0.125", "integral_window = 0", 76,
       "diagnosis.thresholds.integral_window: is 0; expected a number > 0"},
      {"rows = 2", "rows = -1", 79,
       "diagnosis.estimation.rows: is -1; expected an integer from 0 to 100"},
      {"sampling = 0.004", "sampling = 0", 80,
       "diagnosis.estimation.sampling: is 0; expected a number > 0"},
      {"horizon = 1.5", "horizon = -1.5", 81,
       "diagnosis.estimation.horizon: is -1.5; expected a number >= 0"},
      {"forgetting = 0.75", "forgetting = inf", 82,
       "diagnosis.estimation.forgetting: is inf; expected a number >= 0"},
      {"zeta = 0.02", "zeta = 0", 83,
       "diagnosis.estimation.magnitudes.zeta: is 0; expected a number > 0"},
      {"order = 6", "order = 0", 85,
       "diagnosis.disturbance.order: is 0; expected an integer from 1 to 20"},
      {"cutoff = 200.0", "cutoff = 750.0", 86,
       "diagnosis.disturbance.cutoff: is 750.000000 Hz; expected less than half the "
       "control rate"},
      {"high_pass = { order = 2,", "high_pass = { order = 13,", 87,
       "diagnosis.disturbance.high_pass.order: is 13; expected an integer from 1 to "
       "12"},
      {"cutoff = 40.0", "cutoff = 600.0", 87,
       "diagnosis.disturbance.high_pass.cutoff: is 600.000000 Hz; expected less than "
       "half the "
       "control rate"},
      {"segment = 1024", "segment = 63", 88,
       "diagnosis.disturbance.segment: is 63; expected an integer from 64 to 1000000"},
      {"peak_margin = 0.6", "peak_margin = -0.1", 89,
       "diagnosis.disturbance.peak_margin: is -0.1; expected a number >= 0"},
      {"total_margin = 0.7", "total_margin = -0.1", 90,
       "diagnosis.disturbance.total_margin: is -0.1; expected a number >= 0"},
      {"tone_false_alarm = 1e-3", "tone_false_alarm = 0", 91,
       "diagnosis.disturbance.tone_false_alarm: is 0; expected a number > 0 and <= 1"},
      {"degree = 9", "degree = 41", 93,
       "diagnosis.robust.degree: is 41; expected an integer from 1 to 40"},
      {"order = 10", "order = 0", 94,
       "diagnosis.robust.order: is 0; expected an integer from 1 to 20"},
      {"cutoff = 150.0", "cutoff = 1000", 95,
       "diagnosis.robust.cutoff: is 1000.000000 Hz; expected less than half the "
       "control rate"},
      {"runs = 12", "runs = 1", 96,
       "diagnosis.robust.runs: is 1; expected an integer from 2 to 1000"},
      // names
      {R"(trajectories = ["slow", "fast"])", R"(trajectories = ["slow", "swift"])", 77,
       "diagnosis.thresholds.trajectories: there is no trajectory 'swift'; expected "
       "names under [trajectories]"},
      // studies
      {"zeta = 1.01", "zeta = -1.01", 98,
       "studies.small.zeta: is -1.01; expected a number >= 0"},
      {"zeta = 1.01", "zeta = \"much\"", 98,
       "studies.small.zeta: is text; expected a number >= 0"},
      {"zeta = 1.01", "\"zeta 1\" = 1.01", 98,
       "studies.small.zeta 1: is not a name; expected letters, digits and _, beginning "
       "with a letter"},
      {"[studies.small]", "[studies]\nsmall = 1\n[studies.tiny]", 98,
       "studies.small: is an integer; expected a table"},
  };
  for (const BadSetup& bad : cases) {
    EXPECT_EQ(MessageWith(bad.from, bad.to), At(bad.line, bad.message))
        << bad.from << " -> " << bad.to;
  }
}

TEST_F(SetupErrors, RefusesToNameFilesThatAreNotThere) {
  for (const char* name : {"plant.xml", "analytic.toml", "published.toml"}) {
    fs::rename(folder_ / name, folder_ / "elsewhere");
    EXPECT_THAT(Message({}), HasSubstr("there is no file " + (folder_ / name).string() +
                                       "; expected a file beside the setup"));
    fs::rename(folder_ / "elsewhere", folder_ / name);
  }
}

TEST_F(SetupErrors, RefusesAMachineWithoutChannels) {
  const std::string head =
      "schema='mjdiag.setup/1'\nname='n'\nplant='plant.xml'\nrates={control=1}\n";
  const std::string sensor = "sensors.q={element='e', unit='m'}\n";
  const std::string actuator = "actuators.u={element='m', unit='N'}\n";
  Write(head + actuator);
  EXPECT_THAT(Message({}), HasSubstr("sensors: is empty; expected a sensor at least"));
  Write(head + sensor);
  EXPECT_THAT(Message({}),
              HasSubstr("actuators: is empty; expected an actuator at least"));
  Write(head + sensor + actuator + "[record]\n");
  EXPECT_EQ(Message({}), At(7,
                            "record.channels: is empty; expected the column of a "
                            "channel at least"));
  Write(head + sensor + actuator);
  EXPECT_EQ(Message({}), "nothing thrown");
}

TEST_F(SetupErrors, OfAnUnknownChannelSaysWhichThereAre) {
  const auto setup = ReadSetup(folder_);
  EXPECT_THAT(
      [&] { setup.channels.Sensor("x"); },
      ::testing::ThrowsMessage<InputError>(
          "setup 'stage': there is no sensor channel 'x'; expected one of q, a"));
  EXPECT_THROW(setup.channels.Actuator("q"), InputError);
  EXPECT_THROW(setup.trajectories.Find("x"), InputError);
}

}  // namespace
}  // namespace mjdiag
