// mjdiag init, and commands that take a plant in the place of a setup.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/command_line.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class InitCommand : public ::testing::Test {
 protected:
  /// Two links, without motors and sensors.
  static constexpr const char* kUrdf = R"(<robot name="two_link">
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="20" velocity="5"/>
    <dynamics damping="0.1"/></joint>
  <link name="upper"><inertial><origin xyz="0 0 -0.15"/><mass value="1.5"/>
    <inertia ixx=".01" iyy=".01" izz=".002" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="elbow" type="revolute"><origin xyz="0 0 -0.3"/><parent link="upper"/>
    <child link="lower"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="20" velocity="5"/>
    <dynamics damping="0.1"/></joint>
  <link name="lower"><inertial><origin xyz="0 0 -0.1"/><mass value="0.8"/>
    <inertia ixx=".004" iyy=".004" izz=".001" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>)";

  std::string Path(const std::string& name) const {
    return " '" + (folder_ / name).string() + "'";
  }
  /// Torques, then what the voice coil or the URDF does under them, by the simulation.
  void Measure(const std::string& setup, const std::string& inputs) {
    const CommandResult run =
        RunCommand("simulate --setup" + setup + " --replay '" +
                   folder_.Write("inputs.csv", inputs) + "' --out" + Path("measured"));
    ASSERT_EQ(run.status, 0) << run.err;
  }
  static std::string TwoTorques(const std::string& header) {
    std::string text = header + "\n";
    for (int k = 0; k < 1000; ++k) {
      text += std::to_string(0.002 * k) + "," +
              std::to_string(2.0 * std::sin(0.006 * k) + std::sin(0.021 * k)) + "," +
              std::to_string(0.6 * std::sin(0.013 * k)) + "\n";
    }
    return text;
  }
  /// The log of a machine that a URDF describes.
  void MeasureTheUrdf() {
    folder_.Write("arm.urdf", kUrdf);
    const CommandResult init =
        RunCommand("init --plant" + Path("arm.urdf") + " --out" + Path("truth"));
    ASSERT_EQ(init.status, 0) << init.err;
    Measure(Path("truth"),
            TwoTorques("time [s],shoulder_input [N m],elbow_input [N m]"));
  }

  TemporaryFolder folder_;
};

TEST_F(InitCommand, GivesAUrdfTheMotorsAndSensorsOfItsLog) {
  MeasureTheUrdf();
  const std::string record = Path("measured/record.csv");
  const CommandResult init =
      RunCommand("init --plant" + Path("arm.urdf") + " --record" + record + " --out" +
                 Path("drafted") + " --json");
  ASSERT_EQ(init.status, 0) << init.err;
  const json document = json::parse(init.out);
  EXPECT_EQ(document["sensors"].size(), 2u);
  EXPECT_EQ(document["actuators"].size(), 2u);
  // The drafted setup is the machine that made the log.
  const CommandResult compare = RunCommand("compare --setup" + Path("drafted") +
                                           " --record" + record + " --json");
  ASSERT_EQ(compare.status, 0) << compare.err;
  EXPECT_LT(json::parse(compare.out)["channels"]["elbow"]["relative_error_percent"],
            1e-6);
}

TEST_F(InitCommand, StandsInForASetupInComparisons) {
  MeasureTheUrdf();
  const std::string record = " --record" + Path("measured/record.csv") + " --json";
  RunCommand("init --plant" + Path("arm.urdf") + " --record" +
             Path("measured/record.csv") + " --out" + Path("drafted"));
  const json by_plant =
      json::parse(RunCommand("compare --plant" + Path("arm.urdf") + record).out);
  const json by_setup =
      json::parse(RunCommand("compare --setup" + Path("drafted") + record).out);
  EXPECT_EQ(by_plant["channels"], by_setup["channels"]);
  EXPECT_EQ(by_plant["deviance"], by_setup["deviance"]);
}

TEST_F(InitCommand, LinearizesAPlantWithoutASetup) {
  const json by_plant =
      json::parse(RunCommand("linearize --plant mjcf/panda/plant.xml --json").out);
  const json by_setup =
      json::parse(RunCommand("linearize --setup mjcf/panda --json").out);
  EXPECT_EQ(by_plant["M"], by_setup["M"]);
  EXPECT_EQ(by_plant["Gamma"], by_setup["Gamma"]);
}

TEST_F(InitCommand, WritesItsQuestionsAndSaysSoByItsStatus) {
  const std::string log =
      folder_.Write("log.csv", "time [s],foo,bar\n0,1,2\n0.01,2,3\n0.02,2,3\n");
  const CommandResult init =
      RunCommand("init --plant mjcf/voice_coil/plant.xml --record '" + log + "' --out" +
                 Path("drafted"));
  EXPECT_EQ(init.status, 1);
  EXPECT_THAT(init.out, HasSubstr("could not be told"));
  EXPECT_THAT(ReadAll(folder_ / "drafted/setup.toml"), HasSubstr("'foo', 'bar'"));
  const CommandResult compare =
      RunCommand("compare --plant mjcf/voice_coil/plant.xml --record '" + log + "'");
  EXPECT_EQ(compare.status, 2);
  EXPECT_THAT(compare.err, HasSubstr("mjdiag init"));
}

TEST_F(InitCommand, ReplacesNoSetupUnlessAsked) {
  const std::string line = "init --plant mjcf/panda/plant.xml --out" + Path("drafted");
  EXPECT_EQ(RunCommand(line).status, 0);
  const std::string before = ReadAll(folder_ / "drafted/setup.toml");
  const CommandResult again = RunCommand(line);
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("--force"));
  EXPECT_EQ(ReadAll(folder_ / "drafted/setup.toml"), before);
  EXPECT_EQ(RunCommand(line + " --force").status, 0);
}

TEST_F(InitCommand, LeavesNothingBehindWhereItFails) {
  const CommandResult init = RunCommand("init --plant mjcf/panda/plant.xml --record" +
                                        Path("none.csv") + " --out" + Path("drafted"));
  EXPECT_EQ(init.status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "drafted"));
}

}  // namespace
}  // namespace mjdiag
