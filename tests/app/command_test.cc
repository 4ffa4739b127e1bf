// The command as other programs see it: files, JSON fields, exit status.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/command_line.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

json JsonOf(const std::string& arguments, int status = 0) {
  const CommandResult result = RunCommand(arguments + " --json");
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_EQ(result.err, "");
  return json::parse(result.out);
}

TEST(Command, HasHelpForEverySubcommand) {
  EXPECT_THAT(RunCommand("--help").out, HasSubstr("simulate"));
  for (const char* name : {"simulate", "linearize", "design", "diagnose", "compare",
                           "discover", "render", "study"}) {
    const CommandResult result = RunCommand(std::string(name) + " --help");
    EXPECT_EQ(result.status, 0);
    EXPECT_THAT(result.out, HasSubstr("--setup"));
  }
}

TEST(Command, SimulateWritesARecordAndItsSummary) {
  const TemporaryFolder folder;
  const json document =
      JsonOf("simulate --setup mjcf/ab383 --duration 0.1 --fault " +
             std::string("zeta_x=1.2 --out '") + folder.path().string() + "'");
  EXPECT_EQ(document["samples"], 800);
  EXPECT_DOUBLE_EQ(document["sample_time"], 1.25e-4);
  EXPECT_LT(document["tracking_error_max"]["x"], 1e-4);
  EXPECT_GT(document["real_time_factor"], 0.0);
  EXPECT_EQ(document["faults"][0]["name"], "zeta_x");
  EXPECT_EQ(json::parse(ReadAll(folder.path() / "simulate.json"))["samples"], 800);
  EXPECT_THAT(ReadAll(folder.path() / "record.csv"), HasSubstr("time [s],x_ref [m]"));
}

TEST(Command, SimulateGivesTheSameBytesForTheSameSeed) {
  const TemporaryFolder folder;
  const auto record = [&](const std::string& name, int seed) {
    const std::string out = (folder.path() / name).string();
    RunCommand("simulate --setup mjcf/ab383 --duration 0.05 --seed " +
               std::to_string(seed) + " --out '" + out + "'");
    return ReadAll(out + "/record.csv");
  };
  const std::string first = record("a", 7);
  EXPECT_EQ(first, record("b", 7));
  EXPECT_NE(first, record("c", 8));
}

TEST(Command, LetsAFaultAppearInTheCourseOfARun) {
  const std::string run = "simulate --setup mjcf/ab383 --linear --duration 0.1 --json ";
  const auto error = [&](const std::string& faults) {
    const CommandResult result = RunCommand(run + faults);
    EXPECT_EQ(result.status, 0) << result.err;
    const auto document = nlohmann::json::parse(result.out);
    return document["tracking_error_max"]["x"].get<double>();
  };
  const double healthy = error("");
  EXPECT_EQ(error("--fault eta_x=0.7@0.099"), healthy);
  EXPECT_GT(error("--fault eta_x=0.7@0.02"), 5.0 * healthy);
  EXPECT_LT(error("--fault eta_x=0.7@0.02 --fault eta_x=1@0.03"),
            error("--fault eta_x=0.7@0.02"));
}

TEST(Command, RefusesAFaultAtNoTime) {
  for (const char* fault :
       {"eta_x=0.7@", "eta_x=0.7@-1", "eta_x=0.7@nan", "eta_x=@1"}) {
    EXPECT_EQ(
        RunCommand("simulate --setup mjcf/ab383 --fault " + std::string(fault)).status,
        2)
        << fault;
  }
}

TEST(Command, LinearizeAgreesWithTheAnalyticModelAndThePrint) {
  const json document = JsonOf("linearize --setup mjcf/ab383 --compare --published");
  EXPECT_EQ(document["coordinates"].size(), 10u);
  EXPECT_EQ(document["M"].size(), 10u);
  EXPECT_EQ(document["Gamma"][0].size(), 3u);
  EXPECT_EQ(document["modes"].size(), 10u);
  for (const char* matrix : {"M", "D", "K", "Gamma", "b"}) {
    EXPECT_LT(document["difference"][matrix], 1e-9) << matrix;
  }
  EXPECT_LT(document["difference"]["tick"], 1e-8);
  EXPECT_EQ(document["published"]["coefficients"].size(), 35u);
  EXPECT_LT(document["published"]["worst_half_ulp"], 2.0);
}

TEST(Command, LinearizeOfAFaultyMachineIsANegativeAnswer) {
  JsonOf("linearize --setup mjcf/ab383 --fault zeta_x=1.001 --compare", 1);
}

TEST(Command, LinearizeRefusesWhatIsNotLinear) {
  EXPECT_EQ(RunCommand("linearize --setup mjcf/ab383 --fault gamma=1").status, 2);
  EXPECT_EQ(
      RunCommand("linearize --setup mjcf/ab383 --effect force_offset@X:force=1").status,
      2);
}

TEST(Command, AddedFrictionStaysWhenThePlantsOwnIsOff) {
  const auto error = [](const std::string& more) {
    return JsonOf("simulate --setup mjcf/ab383 --duration 0.05 --no-friction " +
                  more)["tracking_error_max"]["x"]
        .get<double>();
  };
  EXPECT_GT(error("--effect coulomb_friction@X:force=20"), 1.2 * error(""));
}

TEST(Command, CompareFindsNothingInARecordOfTheSamePlant) {
  const TemporaryFolder folder;
  const std::string out = folder.path().string();
  ASSERT_EQ(RunCommand("simulate --setup mjcf/ab383 --duration 0.2 --out '" + out + "'")
                .status,
            0);
  const json same =
      JsonOf("compare --setup mjcf/ab383 --record '" + out + "/record.csv'");
  for (const auto& [name, channel] : same["channels"].items()) {
    EXPECT_EQ(channel["exceeds_noise"], false) << name << " " << channel.dump();
  }
  const json other = JsonOf("compare --setup mjcf/ab383 --fault zeta_x=1.2 --record '" +
                            out + "/record.csv'");
  EXPECT_EQ(other["channels"]["x"]["exceeds_noise"], true);
}

// Dry friction slips now and then under encoder noise, so that the power of a healthy
// mismatch varies much more than white noise would. 3 records of 6 channels at a level
// of 1 %: more than two alarms have a chance below 0.1 %.
TEST(Command, CompareRaisesNoFalseAlarmsOnStickSlip) {
  const TemporaryFolder folder;
  const std::string out = folder.path().string();
  int alarms = 0;
  for (const char* seed : {"11", "12", "13"}) {
    RunCommand(std::string("simulate --setup mjcf/ab383 --duration 0.3 --seed ") +
               seed + " --out '" + out + "'");
    const json compared =
        JsonOf("compare --setup mjcf/ab383 --record '" + out + "/record.csv'");
    for (const auto& channel : compared["channels"]) {
      alarms += channel["exceeds_noise"].get<bool>() ? 1 : 0;
    }
  }
  EXPECT_LE(alarms, 2);
}

TEST(Command, RenderWritesAClip) {
  const TemporaryFolder folder;
  const json document = JsonOf(
      "render --setup mjcf/emps --duration 0.5 --fault zeta=2 --speed 0.5 --width 320 "
      "--height 240 --out '" +
      folder.path().string() + "'");
  EXPECT_GT(document["frames"], 20);
  EXPECT_GT(std::filesystem::file_size(folder.path() / "clip.mp4"), 1000u);
}

TEST(Command, RenderOfARecordLastsAsLongAsAsked) {
  const TemporaryFolder folder;
  const std::string out = "'" + folder.path().string() + "'";
  ASSERT_EQ(
      RunCommand("simulate --setup mjcf/ab383 --duration 0.5 --out " + out).status, 0);
  const json document = JsonOf(
      "render --setup mjcf/ab383 --record " + out +
      "/record.csv --duration 0.2 --speed 0.5 --width 320 --height 240 --out " + out);
  EXPECT_EQ(document["frames"], 13);  // 0.4 s of 30 a second, and the first
}

TEST(Command, SaysWhichActuatorsNothingDrives) {
  const TemporaryFolder folder;
  folder.Write("plant.xml", R"(<mujoco><option timestep="0.001" integrator="Euler"/>
  <worldbody><body><joint name="j" type="slide" stiffness="100" damping="1"/>
    <geom size="0.1" mass="1"/></body></worldbody>
  <actuator><motor name="m" joint="j"/><motor name="brake" joint="j"/></actuator>
  <sensor><jointpos name="s" joint="j"/></sensor></mujoco>)");
  folder.Write("setup.toml", R"(schema = "mjdiag.setup/1"
name = "two motors"
plant = "plant.xml"
[rates]
control = 1000.0
substeps = 1
[sensors.x]
element = "s"
unit = "m"
noise_sd = 1e-6
[actuators.u]
element = "m"
unit = "N"
)");
  std::string record = "time [s],u [N],x [m]\n";
  for (int k = 0; k < 400; ++k) {
    record += std::to_string(k * 0.001) + "," + std::to_string(k / 100 % 2) + ",0\n";
  }
  folder.Write("record.csv", record);
  const std::string at = "'" + folder.path().string() + "'";
  const json document =
      JsonOf("compare --setup " + at + " --record " + at + "/record.csv");
  EXPECT_EQ(document["notes"].back(),
            "actuator 'brake' of the plant is 0 all the time: no [actuators] of the "
            "setup gives an input");
}

}  // namespace
}  // namespace mjdiag
