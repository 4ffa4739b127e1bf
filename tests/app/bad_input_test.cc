// Bad input gets one line on stderr that says what, where and what was expected, exit
// status 2, and leaves no file behind.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "app/command_line.h"

namespace mjdiag {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class BadInput : public ::testing::Test {
 protected:
  /// The one line of a command that must be refused.
  std::string Refused(const std::string& arguments) {
    const std::string out = (folder_.path() / "out").string();
    const CommandResult result = RunCommand(arguments + " --out '" + out + "'");
    EXPECT_EQ(result.status, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << arguments;
    return result.err;
  }
  std::string Emps(const std::string& record) {
    return Refused("compare --setup mjcf/emps --record '" + record + "'");
  }
  /// A copy of a plant's folder with one change.
  std::string Changed(const std::string& plant, const std::string& file,
                      const std::string& from, const std::string& to) {
    const std::filesystem::path copy = folder_.path() / plant;
    std::filesystem::copy(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/" + plant, copy,
                          std::filesystem::copy_options::recursive);
    std::string text = ReadAll(copy / file);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    std::ofstream(copy / file) << text;
    return copy.string();
  }
  TemporaryFolder folder_;
};

constexpr const char* kHeader = "t [s],qg [m],qm [m],vir [V]\n";

TEST_F(BadInput, MissingColumnIsNamed) {
  const std::string record =
      folder_.Write("r.csv", "t [s],qg [m],qm [m]\n0,0,0\n1e-3,0,0\n");
  EXPECT_THAT(Emps(record), AllOf(HasSubstr("r.csv"), HasSubstr("vir")));
}

TEST_F(BadInput, NotANumberIsPlaced) {
  const std::string record = folder_.Write(
      "r.csv", std::string(kHeader) + "0,0,0,0\n0.001,0,1.2.3,0\n0.002,0,0,0\n");
  EXPECT_THAT(Emps(record), AllOf(HasSubstr("r.csv: line 3"), HasSubstr("qm")));
}

TEST_F(BadInput, ClockThatBeginsAnewIsPlaced) {
  const std::string record = folder_.Write(
      "r.csv", std::string(kHeader) + "0,0,0,0\n0.001,0,0,0\n0,0,0,0\n0.001,0,0,0\n");
  EXPECT_THAT(Emps(record), HasSubstr("r.csv: line 4"));
}

TEST_F(BadInput, UnknownUnitIsNamed) {
  const std::string record =
      folder_.Write("r.csv", "time [s],x [furlong]\n0,0\n0.000125,0\n");
  EXPECT_THAT(Refused("compare --setup mjcf/ab383 --record '" + record + "'"),
              AllOf(HasSubstr("r.csv"), HasSubstr("furlong")));
}

TEST_F(BadInput, EmptyFileIsSaidToBeEmpty) {
  EXPECT_THAT(Emps(folder_.Write("r.csv", "")),
              AllOf(HasSubstr("r.csv"), HasSubstr("empty")));
}

TEST_F(BadInput, MissingFileIsNamed) {
  EXPECT_THAT(Emps("/nowhere/r.csv"), HasSubstr("/nowhere/r.csv"));
}

TEST_F(BadInput, TruncatedMatIsRefused) {
  const std::string out = (folder_.path() / "good").string();
  ASSERT_EQ(RunCommand("simulate --setup mjcf/emps --duration 1 --format mat --out '" +
                       out + "'")
                .status,
            0);
  const std::string whole = ReadAll(out + "/record.mat");
  for (const double part : {0.1, 0.5, 0.95}) {
    const std::string file = folder_.Write(
        "cut.mat", whole.substr(0, static_cast<std::size_t>(
                                       part * static_cast<double>(whole.size()))));
    EXPECT_THAT(Refused("simulate --setup mjcf/emps --replay '" + file + "'"),
                HasSubstr("cut.mat"));
  }
}

TEST_F(BadInput, UnknownJointInAFaultParameterIsNamed) {
  const std::string setup =
      Changed("emps", "plant.xml", "damping load", "damping lode");
  EXPECT_THAT(Refused("simulate --setup '" + setup + "'"),
              AllOf(HasSubstr("lode"), HasSubstr("load")));
}

TEST_F(BadInput, UnknownFaultListsTheKnownOnes) {
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --fault zeta_q=1.1"),
              AllOf(HasSubstr("zeta_q"), HasSubstr("zeta_x"), HasSubstr("eta_z")));
}

TEST_F(BadInput, UnknownEffectListsTheKnownOnes) {
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --effect stiction@X:force=1"),
              AllOf(HasSubstr("stiction"), HasSubstr("coulomb_friction")));
}

TEST_F(BadInput, ValueOutOfRangeIsNamed) {
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --fault zeta_x=-1"),
              HasSubstr("zeta_x"));
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --set rates.substeps=0"),
              HasSubstr("rates.substeps"));
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --duration -1"),
              HasSubstr("duration"));
}

TEST_F(BadInput, MalformedTomlIsPlaced) {
  const std::string setup = Changed("emps", "setup.toml", "[rates]", "[rates");
  EXPECT_THAT(Refused("simulate --setup '" + setup + "'"), HasSubstr("setup.toml:"));
}

TEST_F(BadInput, UnknownKeyIsPlaced) {
  const std::string setup = Changed("emps", "setup.toml", "substeps", "substep");
  EXPECT_THAT(Refused("simulate --setup '" + setup + "'"),
              AllOf(HasSubstr("setup.toml:"), HasSubstr("substep")));
}

TEST_F(BadInput, MalformedMjcfIsPlaced) {
  const std::string setup = Changed("emps", "plant.xml", "</worldbody>", "");
  EXPECT_THAT(Refused("simulate --setup '" + setup + "'"), HasSubstr("plant.xml:"));
}

TEST_F(BadInput, UsageErrorsAreOneLine) {
  EXPECT_THAT(Refused("simulate"), HasSubstr("--setup"));
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --mode neither"),
              HasSubstr("neither"));
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --trajectory moonwalk"),
              HasSubstr("moonwalk"));
  EXPECT_THAT(Refused("fly"), HasSubstr("fly"));
}

TEST_F(BadInput, ContradictingAndMeaninglessOptionsAreRefused) {
  const std::string ab383 = "simulate --setup mjcf/ab383 ";
  EXPECT_THAT(Refused(ab383 + "--fault zeta_x=1.1 --fault zeta_x=1.2"),
              HasSubstr("twice"));
  EXPECT_THAT(Refused(ab383 + "--duration nan"), HasSubstr("--duration"));
  EXPECT_THAT(Refused(ab383 + "--duration 1e30"), HasSubstr("--duration"));
  EXPECT_THAT(Refused(ab383 + "--noise nan"), HasSubstr("--noise"));
  EXPECT_THAT(Refused("simulate --setup mjcf/emps --mode feedforward --duration 1"),
              HasSubstr("nested"));
  EXPECT_THAT(Refused("render --setup mjcf/emps --record r.csv --fault zeta=2"),
              HasSubstr("excludes"));
  EXPECT_THAT(Refused("render --setup mjcf/emps --fps 1e9"), HasSubstr("--fps"));
}

TEST_F(BadInput, ChannelInAnotherUnitThanTheSetupsIsNamed) {
  const std::string record =
      folder_.Write("r.csv",
                    "time [s],x_ref [N],y_ref [m],z_ref [rad],x [m],y [m],z [rad]\n"
                    "0,0,0,0,0,0,0\n0.000125,0,0,0,0,0,0\n");
  EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --replay '" + record + "'"),
              AllOf(HasSubstr("x_ref"), HasSubstr("'N'")));
}

TEST_F(BadInput, IntegratorOfSeveralStagesIsRefusedForTheLinearPlant) {
  const std::string setup =
      Changed("emps", "plant.xml", "integrator=\"Euler\"", "integrator=\"RK4\"");
  EXPECT_THAT(Refused("simulate --linear --setup '" + setup + "'"),
              HasSubstr("integrator"));
}

TEST_F(BadInput, UnwritableFolderIsNamedBeforeAnythingRuns) {
  const CommandResult result =
      RunCommand("simulate --setup mjcf/ab383 --out /proc/mjdiag/out");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("/proc/mjdiag"));
  const std::string file = folder_.Write("file", "not a folder");
  EXPECT_EQ(RunCommand("simulate --setup mjcf/ab383 --out '" + file + "/out'").status,
            2);
  EXPECT_EQ(ReadAll(file), "not a folder");
}

TEST_F(BadInput, UnknownCameraListsTheKnownOnes) {
  const CommandResult result =
      RunCommand("render --setup mjcf/ab383 --duration 0.05 --camera moon --out '" +
                 (folder_.path() / "clip").string() + "'");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("moon"), HasSubstr("machine")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "clip"));
}

TEST(Divergence, EndsWithStatus3AndSaysWhenAndWhere) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  const CommandResult result = RunCommand(
      "simulate --setup mjcf/ab383 --set axes.x.drive_gain=-60 --out '" + out + "'");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, AllOf(HasSubstr("diverged at 0."), HasSubstr("joint '")));
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_FALSE(std::filesystem::exists(MJDIAG_SOURCE_DIR "/MUJOCO_LOG.TXT"));
}

}  // namespace
}  // namespace mjdiag
