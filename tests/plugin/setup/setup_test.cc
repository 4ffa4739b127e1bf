#include "mjdiag/plugin/setup/setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup_reader.h"
#include "mjdiag/signals/error.h"
#include "plugin/setup/setup_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

const fs::path kSource = MJDIAG_SOURCE_DIR;

std::string ReadAll(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST_F(SetupFile, FillsTheMachine) {
  const auto setup = ReadSetup(folder_);
  EXPECT_EQ(setup.folder, folder_);
  EXPECT_EQ(setup.name, "stage");
  EXPECT_EQ(setup.plant, folder_ / "plant.xml");
  EXPECT_EQ(setup.analytic, folder_ / "analytic.toml");
  EXPECT_EQ(setup.published, folder_ / "published.toml");
  EXPECT_EQ(setup.rates.control, 1000.0);
  EXPECT_EQ(setup.rates.tick(), 1e-3);
  EXPECT_EQ(setup.rates.substeps, 4);
  EXPECT_FALSE(setup.physics.gravity);
  EXPECT_FALSE(setup.physics.static_friction);
}

TEST_F(SetupFile, FillsTheChannelsInTheOrderOfTheFile) {
  const auto setup = ReadSetup(folder_);
  ASSERT_EQ(setup.channels.sensors.size(), 2u);
  EXPECT_EQ(setup.channels.sensors[0].channel, "q");
  EXPECT_EQ(setup.channels.sensors[1].channel, "a");
  const SensorSetup& q = setup.channels.Sensor("q");
  EXPECT_EQ(q.element, "encoder");
  EXPECT_EQ(q.component, 1);
  EXPECT_EQ(q.unit, "m");
  EXPECT_DOUBLE_EQ(q.noise_sd, std::sqrt(4e-19 * 1000.0));
  EXPECT_EQ(q.resolution, 1e-9);
  EXPECT_EQ(setup.channels.Sensor("a").noise_sd, 3e-8);
  EXPECT_EQ(setup.channels.Sensor("a").component, 0);

  ASSERT_EQ(setup.channels.actuators.size(), 2u);
  EXPECT_EQ(setup.channels.actuators[0].channel, "u");
  EXPECT_EQ(setup.channels.Actuator("u").element, "motor");
  EXPECT_EQ(setup.channels.Actuator("u").limit, 50.0);
  EXPECT_EQ(setup.channels.Actuator("t").unit, "N m");
  EXPECT_EQ(setup.channels.Actuator("t").limit, 0.0);
}

TEST_F(SetupFile, FillsWhatSwitchesActuatorsAndHowInputsGoOnBetweenSamples) {
  const auto plain = ReadSetup(folder_);
  EXPECT_EQ(plain.channels.Actuator("u").enabled_by, "");
  EXPECT_EQ(plain.channels.Actuator("u").hold, Hold::kZero);
  EXPECT_THAT(plain.channels.Switches(), IsEmpty());
  const auto setup = ReadSetup(
      folder_, {R"(actuators.u.enabled_by="on")", R"(actuators.u.hold="linear")",
                R"(actuators.t.enabled_by="on")", R"(actuators.t.hold="band_limited")",
                R"(record.channels.on.column="torque on")"});
  EXPECT_EQ(setup.channels.Actuator("u").enabled_by, "on");
  EXPECT_EQ(setup.channels.Actuator("u").hold, Hold::kLinear);
  EXPECT_EQ(setup.channels.Actuator("t").hold, Hold::kBandLimited);
  EXPECT_THAT(setup.channels.Switches(), ElementsAre("on"));
}

TEST_F(SetupFile, FillsTheAxes) {
  const auto setup = ReadSetup(folder_);
  ASSERT_EQ(setup.control.axes.size(), 2u);
  const AxisSetup& s = setup.control.axes[0];
  EXPECT_EQ(s.name, "s");
  EXPECT_EQ(s.sensor, "q");
  EXPECT_EQ(s.actuator, "u");
  EXPECT_EQ(s.drive_gain, 20.5);
  EXPECT_EQ(s.known_disturbance, "pulse");
  EXPECT_EQ(s.feedforward.snap, 1e-9);
  EXPECT_EQ(s.feedforward.acceleration, 0.1);
  EXPECT_EQ(s.feedforward.velocity, 0.5);
  ASSERT_TRUE(s.feedback);
  EXPECT_THAT(s.feedback->numerator, ElementsAre(3.0, -2.5));
  EXPECT_THAT(s.feedback->denominator, ElementsAre(1.0, -0.5));
  EXPECT_FALSE(s.nested);
  EXPECT_EQ(s.limits.velocity, 0.5);
  EXPECT_EQ(s.limits.snap, 4e5);

  const AxisSetup& r = setup.control.axes[1];
  EXPECT_EQ(r.drive_gain, 1.0);
  EXPECT_EQ(r.known_disturbance, "");
  ASSERT_TRUE(r.nested);
  EXPECT_EQ(r.nested->position_gain, 160.0);
  EXPECT_EQ(r.nested->velocity_gain, 240.0);
  EXPECT_EQ(r.nested->saturation, 10.0);
}

TEST_F(SetupFile, FillsDisturbancesAndTrajectories) {
  const auto setup = ReadSetup(folder_);
  ASSERT_EQ(setup.disturbances.size(), 1u);
  EXPECT_EQ(setup.disturbances[0].name, "hum");
  EXPECT_THAT(setup.disturbances[0].frequencies, ElementsAre(50.0, 150.0));
  EXPECT_DOUBLE_EQ(setup.disturbances[0].amplitude.at("u"), 4.5);

  ASSERT_EQ(setup.trajectories.all.size(), 2u);
  EXPECT_EQ(setup.trajectories.fallback, "slow");
  const Trajectory& fast = setup.trajectories.Find("fast");
  EXPECT_EQ(fast.duration, 2.0);
  EXPECT_EQ(fast.period, 1.0);
  ASSERT_EQ(fast.moves.size(), 2u);
  EXPECT_EQ(fast.moves[0].at, 0.1);
  EXPECT_EQ(fast.moves[0].by.at("r"), -0.2);
  EXPECT_EQ(fast.moves[1].by.at("s"), -0.01);
  EXPECT_EQ(fast.limits.at("s").jerk, 3000.0);
  EXPECT_EQ(fast.limits.at("r").acceleration, 40.0);
  const Trajectory& slow = setup.trajectories.Find("slow");
  EXPECT_EQ(slow.period, 0.0);
  EXPECT_EQ(slow.limits.at("s").jerk, 2000.0);
  EXPECT_FALSE(slow.limits.contains("r"));
}

TEST_F(SetupFile, FillsRecordAndCompare) {
  const auto setup = ReadSetup(folder_);
  ASSERT_TRUE(setup.record);
  EXPECT_EQ(setup.record->time.column, "t");
  EXPECT_EQ(setup.record->time.unit, "ms");
  ASSERT_EQ(setup.record->columns.size(), 5u);
  EXPECT_EQ(setup.record->columns[0].channel, "s_ref");
  EXPECT_EQ(setup.record->columns[0].column, "setpoint");
  EXPECT_EQ(setup.record->columns[0].unit, "um");
  EXPECT_FALSE(setup.record->columns[0].optional);
  EXPECT_EQ(setup.record->columns[1].unit, "");
  EXPECT_EQ(setup.record->columns[2].column, "u");
  EXPECT_TRUE(setup.record->columns[4].optional);

  EXPECT_EQ(setup.compare.skip_samples, 49);
  EXPECT_EQ(setup.compare.low_pass_order, 4);
  EXPECT_EQ(setup.compare.low_pass_cutoff, 100.0);
  ASSERT_EQ(setup.compare.forces.size(), 1u);
  EXPECT_EQ(setup.compare.forces[0].name, "force");
  EXPECT_EQ(setup.compare.forces[0].channel, "u");
  EXPECT_EQ(setup.compare.forces[0].factor, 35.15);
  EXPECT_EQ(setup.compare.forces[0].unit, "N");
}

TEST_F(SetupFile, FillsTheFiltersAndThresholdsOfTheDiagnosis) {
  const DiagnosisOptions diagnosis = ReadSetup(folder_).diagnosis;
  EXPECT_EQ(diagnosis.residual.degree, 3);
  EXPECT_EQ(diagnosis.residual.denominator.order, 5);
  EXPECT_EQ(diagnosis.residual.denominator.cutoff, 60.0);
  EXPECT_THAT(diagnosis.unknown_forces, ElementsAre("slide", "hinge"));
  EXPECT_EQ(diagnosis.margin, 3.0);
  EXPECT_EQ(diagnosis.false_alarms, 0.01);
  EXPECT_EQ(diagnosis.integral_window, 0.125);
  EXPECT_THAT(diagnosis.trajectories, ElementsAre("slow", "fast"));
  EXPECT_EQ(diagnosis.robust.residual.degree, 9);
  EXPECT_EQ(diagnosis.robust.residual.denominator.order, 10);
  EXPECT_EQ(diagnosis.robust.residual.denominator.cutoff, 150.0);
  EXPECT_EQ(diagnosis.robust.runs, 12);
}

TEST_F(SetupFile, FillsTheEstimationAndDisturbancesOfTheDiagnosis) {
  const DiagnosisOptions diagnosis = ReadSetup(folder_).diagnosis;
  EXPECT_EQ(diagnosis.estimation_residuals, 2);
  EXPECT_EQ(diagnosis.sampling, 0.004);
  EXPECT_EQ(diagnosis.horizon, 1.5);
  EXPECT_EQ(diagnosis.forgetting, 0.75);
  EXPECT_THAT(diagnosis.magnitudes,
              ElementsAre(Pair("beta", 0.03), Pair("zeta", 0.02)));
  EXPECT_EQ(diagnosis.disturbance_denominator.order, 6);
  EXPECT_EQ(diagnosis.disturbance_denominator.cutoff, 200.0);
  EXPECT_EQ(diagnosis.high_pass_order, 2);
  EXPECT_EQ(diagnosis.high_pass_cutoff, 40.0);
  EXPECT_EQ(diagnosis.disturbance.segment, 1024);
  EXPECT_EQ(diagnosis.disturbance.peak_margin, 0.6);
  EXPECT_EQ(diagnosis.disturbance.total_margin, 0.7);
  EXPECT_EQ(diagnosis.disturbance.tone_false_alarm, 1e-3);
}

TEST_F(SetupFile, FillsTheStudiesInTheOrderOfTheFile) {
  const auto setup = ReadSetup(folder_);
  ASSERT_EQ(setup.studies.size(), 2u);
  EXPECT_EQ(setup.studies[0].name, "small");
  EXPECT_EQ(setup.studies[1].name, "large");
  EXPECT_THAT(setup.Study("small").values,
              ElementsAre(Pair("zeta", 1.01), Pair("gamma", 0.002)));
  EXPECT_THAT(setup.Study("large").values,
              ElementsAre(Pair("eta", 0.9), Pair("beta", 0.25)));
  EXPECT_THROW(setup.Study("middle"), InputError);
}

/// The settings of [AB383], chapter 4, as far as the manual gives them as defaults.
TEST_F(SetupFile, WithoutDiagnosisHasTheDefaultsOfTheManual) {
  const std::string text = kEveryKey;
  Write(text.substr(0, text.find("[diagnosis]")));
  const auto setup = ReadSetup(folder_);
  const DiagnosisOptions& diagnosis = setup.diagnosis;
  EXPECT_THAT(setup.studies, IsEmpty());
  EXPECT_EQ(diagnosis.residual.degree, 7);
  EXPECT_EQ(diagnosis.residual.denominator.order, 7);
  EXPECT_EQ(diagnosis.residual.denominator.cutoff, 50.0);
  EXPECT_THAT(diagnosis.unknown_forces, IsEmpty());
  EXPECT_EQ(diagnosis.margin, 2.0);
  EXPECT_EQ(diagnosis.false_alarms, 0.0);
  EXPECT_EQ(diagnosis.integral_window, 0.25);
  EXPECT_THAT(diagnosis.trajectories, IsEmpty());
  EXPECT_EQ(diagnosis.estimation_residuals, 1);
  EXPECT_EQ(diagnosis.sampling, 0.0005);
  EXPECT_EQ(diagnosis.horizon, 0.0);
  EXPECT_EQ(diagnosis.forgetting, 0.0);
  EXPECT_THAT(diagnosis.magnitudes, IsEmpty());
  EXPECT_EQ(diagnosis.disturbance_denominator.order, 7);
  EXPECT_EQ(diagnosis.disturbance_denominator.cutoff, 750.0);
  EXPECT_EQ(diagnosis.high_pass_order, 3);
  EXPECT_EQ(diagnosis.high_pass_cutoff, 100.0);
  EXPECT_EQ(diagnosis.disturbance.segment, 4096);
  EXPECT_EQ(diagnosis.disturbance.peak_margin, 1.0);
  EXPECT_EQ(diagnosis.disturbance.total_margin, 0.25);
  EXPECT_EQ(diagnosis.disturbance.tone_false_alarm, 1e-4);
  EXPECT_EQ(diagnosis.robust.residual.degree, 8);
  EXPECT_EQ(diagnosis.robust.residual.denominator.order, 8);
  EXPECT_EQ(diagnosis.robust.residual.denominator.cutoff, 200.0);
  EXPECT_EQ(diagnosis.robust.runs, 8);
}

TEST_F(SetupFile, IsReadByItsOwnNameToo) {
  EXPECT_EQ(ReadSetup(folder_ / "setup.toml").plant, folder_ / "plant.xml");
}

TEST_F(SetupFile, RunsItsFirstTrajectoryByDefault) {
  EXPECT_EQ(MessageWith("default_trajectory = \"slow\"", ""), "nothing thrown");
  EXPECT_EQ(ReadSetup(folder_).trajectories.fallback, "fast");
}

TEST_F(SetupFile, TakesOverrides) {
  const auto setup = ReadSetup(
      folder_, {"rates.substeps=8", "axes.r.nested.position_gain = 1.5", "name='other'",
                "axes.s.limits={jerk=1.0}", "sensors.b={element='new', unit='m'}",
                "trajectories.slow.moves=[{at=0, by={s=1}}]"});
  EXPECT_EQ(setup.rates.substeps, 8);
  EXPECT_EQ(setup.name, "other");
  EXPECT_EQ(setup.control.axes[1].nested->position_gain, 1.5);
  EXPECT_EQ(setup.control.axes[1].nested->velocity_gain, 240.0);
  EXPECT_EQ(setup.control.axes[0].limits.jerk, 1.0);
  EXPECT_EQ(setup.control.axes[0].limits.snap, 4e5);
  ASSERT_EQ(setup.channels.sensors.size(), 3u);
  EXPECT_EQ(setup.channels.sensors[2].channel, "b");
  EXPECT_EQ(setup.trajectories.Find("slow").moves[0].by.at("s"), 1.0);
}

/// Every stretch of the text between `open` and the next `close`.
std::vector<std::string> Between(const std::string& text, const std::string& open,
                                 const std::string& close) {
  std::vector<std::string> found;
  std::size_t at = text.find(open);
  while (at != std::string::npos) {
    const std::size_t begin = at + open.size();
    const std::size_t end = text.find(close, begin);
    found.push_back(text.substr(begin, end - begin));
    at = text.find(open, end);
  }
  return found;
}

TEST_F(SetupFile, HasExactlyTheKeysThatTheManualLists) {
  std::set<std::string> known;
  ReadSetup(folder_,
            {"trajectories.slow.ramp=0.2",
             "trajectories.slow.tones=[{axis='s', "
             "frequency=20, amplitude=1e-4, phase=0.5}]"},
            known);
  const std::vector<std::string> rows =
      Between(ReadAll(kSource / "docs/setup.md"), "\n| `", "` |");
  const std::set<std::string> listed(rows.begin(), rows.end());
  EXPECT_EQ(rows.size(), listed.size());
  for (const std::string& key : known) {
    EXPECT_TRUE(listed.contains(key)) << key << " is not in the manual";
  }
  for (const std::string& key : listed) {
    EXPECT_TRUE(known.contains(key)) << key << " is not read";
  }
}

TEST_F(SetupFile, OfTheManualsExamplesReads) {
  const std::vector<std::string> examples =
      Between(ReadAll(kSource / "docs/setup.md"), "```toml\n", "```");
  ASSERT_EQ(examples.size(), 2u);
  Write(examples[0]);
  EXPECT_EQ(Message({}), "nothing thrown");
  EXPECT_TRUE(ReadSetup(folder_).control.axes.empty());
  Write(examples[1]);
  EXPECT_EQ(Message({}), "nothing thrown");
  const auto closed = ReadSetup(folder_);
  EXPECT_EQ(closed.control.axes.size(), 1u);
  EXPECT_EQ(closed.diagnosis.residual.degree, 2);
  EXPECT_NO_THROW(SampleTrajectory(
      closed.trajectories.Find(closed.trajectories.fallback), {"slide"}, 1e-3));
}

class ShippedSetup : public ::testing::TestWithParam<const char*> {};

TEST_P(ShippedSetup, HasTrajectoriesThatItsAxesCanFollow) {
  const auto setup = ReadSetup(kSource / "mjcf" / GetParam());
  ASSERT_FALSE(setup.trajectories.all.empty());
  std::vector<std::string> axes;
  for (const AxisSetup& axis : setup.control.axes) axes.push_back(axis.name);
  for (const Trajectory& trajectory : setup.trajectories.all) {
    const Reference reference = SampleTrajectory(trajectory, axes, setup.rates.tick());
    for (const AxisReference& axis : reference.axes) {
      EXPECT_NEAR(axis.position.tail(1)[0], 0.0, 1e-15) << trajectory.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mjcf, ShippedSetup,
                         ::testing::Values("ab383", "emps", "servo"),
                         [](const auto& param_info) { return param_info.param; });

TEST(Ab383Setup, HasTheRatesNoiseAndIntegratorsOfTheSeed) {
  const auto setup = ReadSetup(kSource / "mjcf/ab383");
  EXPECT_EQ(setup.rates.control, 8000.0);
  EXPECT_EQ(setup.rates.substeps, 4);
  for (const SensorSetup& sensor : setup.channels.sensors) {
    EXPECT_NEAR(sensor.noise_sd, 20e-9, 1e-12);
  }
  for (const AxisSetup& axis : setup.control.axes) {
    double at_one = 0.0;
    for (const double a : axis.feedback->denominator) at_one += a;
    if (axis.name == "z") continue;  // has none
    EXPECT_NEAR(at_one, 0.0, 1e-15) << axis.name;
  }
  EXPECT_DOUBLE_EQ(setup.disturbances[0].amplitude.at("u_x"), 4.5);
  EXPECT_DOUBLE_EQ(setup.disturbances[0].amplitude.at("u_z"), 1e-3);
}

TEST(Ab383Setup, ReachesItsRatedAccelerationOnFourMillimetres) {
  const auto setup = ReadSetup(kSource / "mjcf/ab383");
  const Reference x =
      SampleTrajectory(setup.trajectories.Find("x_150g"), {"x"}, setup.rates.tick());
  EXPECT_GT(x.axes[0].acceleration.maxCoeff(), 147.0 * 9.81);
  EXPECT_LE(x.axes[0].acceleration.maxCoeff(), 150.0 * 9.81);
}

}  // namespace
}  // namespace mjdiag
