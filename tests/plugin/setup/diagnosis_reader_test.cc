#include "mjdiag/plugin/setup/diagnosis_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

constexpr const char* kMachine = R"(schema = "mjdiag.setup/1"
name = "stage"
plant = "plant.xml"
rates = { control = 1000.0 }
sensors.q = { element = "encoder", unit = "m" }
actuators.u = { element = "motor", unit = "N" }
[axes.s]
sensor = "q"
actuator = "u"
feedback = { numerator = [1], denominator = [1] }
limits = { velocity = 0.5, acceleration = 20.0, jerk = 2000.0, snap = 4e5 }
[trajectories.slow]
duration = 3.0
moves = [{ at = 0.5, by = { s = 0.02 } }]
[trajectories.fast]
duration = 1.0
moves = [{ at = 0.1, by = { s = 0.01 } }]
)";
constexpr int kMachineLines = 17;

/// Every key of a diagnosis, each with a value that is not its default.
constexpr const char* kDiagnosis = R"([diagnosis]
degree = 9
order = 10
cutoff = 40.0
unknown_forces = ["X", "Y"]
[diagnosis.thresholds]
margin = 3.0
false_alarms = 0.01
integral_window = 0.5
trajectories = ["slow", "fast"]
[diagnosis.estimation]
rows = 0
sampling = 0.002
horizon = 1.5
forgetting = 0.75
magnitudes = { zeta_x = 1e-4, beta_x = 0.02 }
[diagnosis.disturbance]
order = 8
cutoff = 300.0
high_pass = { order = 4, cutoff = 60.0 }
segment = 512
peak_margin = 0.5
total_margin = 0.75
tone_false_alarm = 0.001
[diagnosis.robust]
degree = 11
order = 12
cutoff = 150.0
runs = 5
)";

class DiagnosisReader : public testing::Test {
 protected:
  DiagnosisReader() { folder_.Write("plant.xml", "x"); }

  DiagnosisOptions Read(const std::string& diagnosis) const {
    folder_.Write("setup.toml", kMachine + diagnosis);
    return ReadSetup(folder_.path()).diagnosis;
  }
  /// What is said about every key with `from` replaced by `to`.
  std::string MessageWith(const std::string& from, const std::string& to) const {
    std::string text = kDiagnosis;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return test::MessageOf<InputError>([&] { Read(text); });
  }

  const test::TemporaryFolder folder_;
};

TEST_F(DiagnosisReader, ReadsEveryKey) {
  const DiagnosisOptions options = Read(kDiagnosis);
  EXPECT_EQ(options.residual.degree, 9);
  EXPECT_EQ(options.residual.denominator.order, 10);
  EXPECT_EQ(options.residual.denominator.cutoff, 40.0);
  EXPECT_THAT(options.unknown_forces, ElementsAre("X", "Y"));
  EXPECT_EQ(options.margin, 3.0);
  EXPECT_EQ(options.false_alarms, 0.01);
  EXPECT_EQ(options.integral_window, 0.5);
  EXPECT_THAT(options.trajectories, ElementsAre("slow", "fast"));
  EXPECT_EQ(options.estimation_residuals, 0);
  EXPECT_EQ(options.sampling, 0.002);
  EXPECT_EQ(options.horizon, 1.5);
  EXPECT_EQ(options.forgetting, 0.75);
  EXPECT_THAT(options.magnitudes,
              ElementsAre(Pair("beta_x", 0.02), Pair("zeta_x", 1e-4)));
  EXPECT_EQ(options.disturbance_denominator.order, 8);
  EXPECT_EQ(options.disturbance_denominator.cutoff, 300.0);
  EXPECT_EQ(options.high_pass_order, 4);
  EXPECT_EQ(options.high_pass_cutoff, 60.0);
  EXPECT_EQ(options.disturbance.segment, 512);
  EXPECT_EQ(options.disturbance.peak_margin, 0.5);
  EXPECT_EQ(options.disturbance.total_margin, 0.75);
  EXPECT_EQ(options.disturbance.tone_false_alarm, 0.001);
  EXPECT_EQ(options.robust.residual.degree, 11);
  EXPECT_EQ(options.robust.residual.denominator.order, 12);
  EXPECT_EQ(options.robust.residual.denominator.cutoff, 150.0);
  EXPECT_EQ(options.robust.runs, 5);
}

TEST_F(DiagnosisReader, TakesTheFiltersOfTheSeedWithoutKeys) {
  for (const char* text : {"",
                           "[diagnosis]\nthresholds = {}\nestimation = {}\n"
                           "disturbance = { high_pass = {} }\nrobust = {}\n"}) {
    // The disturbance filter of [AB383] does not fit under a control rate of 1 kHz.
    std::string machine = kMachine;
    machine.replace(machine.find("1000.0"), 6, "8000.0");
    folder_.Write("setup.toml", machine + text);
    const DiagnosisOptions options = ReadSetup(folder_.path()).diagnosis;
    EXPECT_EQ(options.residual.degree, 7);
    EXPECT_EQ(options.residual.denominator.order, 7);
    EXPECT_EQ(options.residual.denominator.cutoff, 50.0);
    EXPECT_EQ(options.disturbance_denominator.order, 7);
    EXPECT_EQ(options.disturbance_denominator.cutoff, 750.0);
    EXPECT_EQ(options.high_pass_order, 3);
    EXPECT_EQ(options.high_pass_cutoff, 100.0);
    EXPECT_EQ(options.margin, 2.0);
    EXPECT_EQ(options.sampling, 0.0005);
    EXPECT_THAT(options.trajectories, IsEmpty());
    EXPECT_THAT(options.magnitudes, IsEmpty());
    EXPECT_THAT(options.unknown_forces, IsEmpty());
  }
}

TEST_F(DiagnosisReader, RefusesBadValuesInOneLine) {
  struct BadDiagnosis {
    const char* from;
    const char* to;
    int line;  ///< of kDiagnosis
    const char* message;
  };
  const std::vector<BadDiagnosis> cases = {
      // unknown keys
      {"degree = 9", "degre = 9", 2,
       "diagnosis.degre: unknown key; expected one of cutoff, degree, disturbance, "
       "estimation, order, robust, thresholds, unknown_forces"},
      {"margin = 3.0", "alpha = 3.0", 7,
       "diagnosis.thresholds.alpha: unknown key; expected one of false_alarms, "
       "integral_window, margin, trajectories"},
      {"rows = 0", "row = 0", 12,
       "diagnosis.estimation.row: unknown key; expected one of forgetting, horizon, "
       "magnitudes, rows, sampling"},
      {"segment = 512", "segments = 512", 21,
       "diagnosis.disturbance.segments: unknown key; expected one of cutoff, "
       "high_pass, order, peak_margin, segment, tone_false_alarm, total_margin"},
      {"{ order = 4, cutoff = 60.0 }", "{ order = 4, cut = 60.0 }", 20,
       "diagnosis.disturbance.high_pass.cut: unknown key; expected one of cutoff, "
       "order"},
      {"runs = 5", "seeds = 5", 29,
       "diagnosis.robust.seeds: unknown key; expected one of cutoff, degree, order, "
       "runs"},
      // the section
      {"degree = 9", "degree = 0", 2,
       "diagnosis.degree: is 0; expected an integer from 1 to 40"},
      {"degree = 9", "degree = 41", 2,
       "diagnosis.degree: is 41; expected an integer from 1 to 40"},
      {"degree = 9", "degree = 9.5", 2,
       "diagnosis.degree: is a number; expected an integer from 1 to 40"},
      {"order = 10", "order = 21", 3,
       "diagnosis.order: is 21; expected an integer from 1 to 20"},
      {"cutoff = 40.0", "cutoff = 0", 4,
       "diagnosis.cutoff: is 0; expected a number > 0"},
      {"cutoff = 40.0", "cutoff = 500.0", 4,
       "diagnosis.cutoff: is 500.000000 Hz; expected less than half the control rate"},
      {"cutoff = 40.0", "cutoff = \"low\"", 4,
       "diagnosis.cutoff: is text; expected a number > 0"},
      {R"(["X", "Y"])", "\"X\"", 5,
       "diagnosis.unknown_forces: is text; expected an array of texts"},
      {R"(["X", "Y"])", "[\"X\", 3]", 5,
       "diagnosis.unknown_forces[1]: is an integer; expected a text"},
      // thresholds
      {"margin = 3.0", "margin = 0.99", 7,
       "diagnosis.thresholds.margin: is 0.99; expected a number >= 1"},
      {"false_alarms = 0.01", "false_alarms = 1", 8,
       "diagnosis.thresholds.false_alarms: is 1; expected a number >= 0 and < 1"},
      {"false_alarms = 0.01", "false_alarms = -0.1", 8,
       "diagnosis.thresholds.false_alarms: is -0.1; expected a number >= 0 and < 1"},
      {"integral_window = 0.5", "integral_window = 0", 9,
       "diagnosis.thresholds.integral_window: is 0; expected a number > 0"},
      {R"(["slow", "fast"])", R"(["slow", "swift"])", 10,
       "diagnosis.thresholds.trajectories: there is no trajectory 'swift'; expected "
       "names under [trajectories]"},
      {R"(["slow", "fast"])", "[3]", 10,
       "diagnosis.thresholds.trajectories[0]: is an integer; expected a text"},
      // estimation
      {"rows = 0", "rows = -1", 12,
       "diagnosis.estimation.rows: is -1; expected an integer from 0 to 100"},
      {"sampling = 0.002", "sampling = 0", 13,
       "diagnosis.estimation.sampling: is 0; expected a number > 0"},
      {"horizon = 1.5", "horizon = -1", 14,
       "diagnosis.estimation.horizon: is -1; expected a number >= 0"},
      {"forgetting = 0.75", "forgetting = inf", 15,
       "diagnosis.estimation.forgetting: is inf; expected a number >= 0"},
      {"zeta_x = 1e-4", "zeta_x = 0", 16,
       "diagnosis.estimation.magnitudes.zeta_x: is 0; expected a number > 0"},
      {"zeta_x = 1e-4", "zeta_x = true", 16,
       "diagnosis.estimation.magnitudes.zeta_x: is a boolean; expected a number > 0"},
      {"zeta_x = 1e-4", "\"zeta x\" = 1e-4", 16,
       "diagnosis.estimation.magnitudes.zeta x: is not a name; expected letters, "
       "digits and _, beginning with a letter"},
      {"magnitudes = { zeta_x = 1e-4, beta_x = 0.02 }", "magnitudes = 1e-4", 16,
       "diagnosis.estimation.magnitudes: is a number; expected a table"},
      // disturbance
      {"order = 8", "order = 0", 18,
       "diagnosis.disturbance.order: is 0; expected an integer from 1 to 20"},
      {"cutoff = 300.0", "cutoff = 500.0", 19,
       "diagnosis.disturbance.cutoff: is 500.000000 Hz; expected less than half the "
       "control rate"},
      {"order = 4", "order = 13", 20,
       "diagnosis.disturbance.high_pass.order: is 13; expected an integer from 1 to "
       "12"},
      {"cutoff = 60.0", "cutoff = 1e3", 20,
       "diagnosis.disturbance.high_pass.cutoff: is 1000.000000 Hz; expected less than "
       "half the control rate"},
      {"high_pass = { order = 4, cutoff = 60.0 }", "high_pass = 3", 20,
       "diagnosis.disturbance.high_pass: is an integer; expected a table"},
      {"segment = 512", "segment = 63", 21,
       "diagnosis.disturbance.segment: is 63; expected an integer from 64 to 1000000"},
      {"peak_margin = 0.5", "peak_margin = -0.5", 22,
       "diagnosis.disturbance.peak_margin: is -0.5; expected a number >= 0"},
      {"total_margin = 0.75", "total_margin = nan", 23,
       "diagnosis.disturbance.total_margin: is nan; expected a number >= 0"},
      {"tone_false_alarm = 0.001", "tone_false_alarm = 0", 24,
       "diagnosis.disturbance.tone_false_alarm: is 0; expected a number > 0 and <= 1"},
      // robust
      {"degree = 11", "degree = 0", 26,
       "diagnosis.robust.degree: is 0; expected an integer from 1 to 40"},
      {"order = 12", "order = 21", 27,
       "diagnosis.robust.order: is 21; expected an integer from 1 to 20"},
      {"cutoff = 150.0", "cutoff = -1", 28,
       "diagnosis.robust.cutoff: is -1; expected a number > 0"},
      {"runs = 5", "runs = 1", 29,
       "diagnosis.robust.runs: is 1; expected an integer from 2 to 1000"},
  };
  const std::string file = (folder_ / "setup.toml").string();
  for (const BadDiagnosis& bad : cases) {
    EXPECT_EQ(
        MessageWith(bad.from, bad.to),
        file + ":" + std::to_string(kMachineLines + bad.line) + ": " + bad.message)
        << bad.from << " -> " << bad.to;
  }
}

TEST_F(DiagnosisReader, RefusesSectionsThatAreNoTables) {
  EXPECT_EQ(test::MessageOf<InputError>([&] {
              folder_.Write("setup.toml", std::string("diagnosis = 1\n") + kMachine);
              ReadSetup(folder_.path());
            }),
            (folder_ / "setup.toml").string() +
                ":1: diagnosis: is an integer; expected a table");
  for (const std::string section :
       {"thresholds", "estimation", "disturbance", "robust"}) {
    EXPECT_EQ(test::MessageOf<InputError>(
                  [&] { Read("[diagnosis]\n" + section + " = true\n"); }),
              (folder_ / "setup.toml").string() + ":" +
                  std::to_string(kMachineLines + 2) + ": diagnosis." + section +
                  ": is a boolean; expected a table");
  }
}

}  // namespace
}  // namespace mjdiag
