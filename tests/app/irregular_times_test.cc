// Records whose times jitter: every command that reads one says so.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/command_line.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr int kSamples = 7500;
constexpr double kTick = 2e-4;  // s
constexpr const char* kNote =
    "time stamps are irregular (their intervals vary by 12 %): "
    "resampled to 200 µs";

/// The stage of the voice coil, whose flexure is stiffer at the ends, as a measurement
/// with times that are off by up to a fifth of a tick.
class IrregularTimes : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream current(folder_.path() / "current.csv");
    current << "time [s],i [A]\n";
    for (int k = 0; k < kSamples; ++k) {
      const double t = k * kTick;
      current << t << "," << 0.2 * std::sin(4.0 * t) + 0.15 * std::sin(31.0 * t)
              << "\n";
    }
    current.close();
    const CommandResult run = RunCommand(
        "simulate --setup mjcf/voice_coil --replay " + File("current.csv") +
        " --effect cubic_stiffness@stage:coefficient=4e6 --out " + File("run"));
    ASSERT_EQ(run.status, 0) << run.err;
    Jitter();
  }
  /// The reading goes straight between its samples.
  void Jitter() const {
    std::ifstream uniform(folder_.path() / "run" / "record.csv");
    std::ofstream jittered(folder_.path() / "jittered.csv");
    jittered.precision(12);
    std::string header;
    std::getline(uniform, header);
    ASSERT_EQ(header, "time [s],x [m],i [A]");
    jittered << header << "\n";
    double x_before = 0.0;
    for (int k = 0; k < kSamples; ++k) {
      double t = 0.0;
      double x = 0.0;
      double i = 0.0;
      char comma = ',';
      uniform >> t >> comma >> x >> comma >> i;
      const double early = k == 0 ? 0.0 : 0.1 + 0.1 * std::sin(2.1 * k);
      jittered << t - early * kTick << "," << x - early * (x - x_before) << "," << i
               << "\n";
      x_before = x;
    }
  }
  std::string File(const std::string& name) const {
    return "'" + (folder_.path() / name).string() + "'";
  }
  /// What a command prints for people and for programs.
  void ExpectNote(const std::string& command, const std::string& more) const {
    const std::string line = command + " --setup mjcf/voice_coil " + more;
    const CommandResult people = RunCommand(line + " --out " + File("out"));
    EXPECT_EQ(people.status, 0) << people.err;
    EXPECT_THAT(people.out, HasSubstr(kNote)) << command;
    const CommandResult programs = RunCommand(line + " --json --out " + File("out"));
    EXPECT_THAT(json::parse(programs.out)["notes"].dump(), HasSubstr(kNote)) << command;
  }
  const TemporaryFolder folder_;
};

TEST_F(IrregularTimes, AreSaidByEveryCommand) {
  const std::string record = "--record " + File("jittered.csv");
  ExpectNote("compare", record);
  ExpectNote("calibrate", record);
  ExpectNote("diagnose", record);
  ExpectNote("simulate", "--replay " + File("jittered.csv"));
}

TEST_F(IrregularTimes, DoNotHideTheCause) {
  const CommandResult found =
      RunCommand("discover --setup mjcf/voice_coil --record " + File("jittered.csv") +
                 " --json --out " + File("found"));
  ASSERT_EQ(found.status, 0) << found.err;
  const json discovery = json::parse(found.out);
  EXPECT_THAT(discovery["notes"].dump(), HasSubstr(kNote));
  ASSERT_FALSE(discovery["causes"].empty());
  const json& cause = discovery["causes"][0];
  EXPECT_EQ(cause["effect"], "cubic_stiffness");
  EXPECT_NEAR(cause["parameters"]["coefficient"]["value"], 4e6, 4e4);
}

TEST_F(IrregularTimes, WithALongGapAreRead) {
  std::ifstream whole(folder_.path() / "jittered.csv");
  std::ofstream part(folder_.path() / "gap.csv");
  int row = 0;
  for (std::string line; std::getline(whole, line); ++row) {
    if (row < 1000 || row >= 1020) part << line << "\n";
  }
  part.close();
  const CommandResult result =
      RunCommand("compare --setup mjcf/voice_coil --record " + File("gap.csv"));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("1 gap of 4.2"));
}

// Nothing is smeared: a sample is a tick, which is as long as the clock of the record has it.
TEST_F(IrregularTimes, OfAClockOfTheirOwnAreTicks) {
  std::ifstream run(folder_.path() / "run" / "record.csv");
  std::ofstream slow(folder_.path() / "slow.csv");
  slow.precision(12);
  std::string line;
  std::getline(run, line);
  slow << line << "\n";
  for (int k = 0; std::getline(run, line); ++k) {
    slow << 1.002 * k * kTick << line.substr(line.find(',')) << "\n";
  }
  slow.close();
  const CommandResult result =
      RunCommand("compare --setup mjcf/voice_coil --record " + File("slow.csv"));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("slow.csv: the sample time is 0.20 % off the control tick: "
                        "its samples are taken as ticks"));
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("resampled")));
}

}  // namespace
}  // namespace mjdiag
