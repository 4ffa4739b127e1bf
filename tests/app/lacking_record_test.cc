// Records that lack something, as loggers leave them, go into every command as they are:
// they say so, and the answers are those of the whole record.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <vector>

#include "app/command_line.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr int kSamples = 7500;
constexpr double kTick = 2e-4;  // s
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// time, reading, command
struct Row {
  double t = 0.0;
  double x = 0.0;
  double i = 0.0;
};
using Rows = std::vector<Row>;

/// The stage of the voice coil, whose flexure is stiffer at the ends.
class LackingRecord : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    Rows current;
    for (int k = 0; k < kSamples; ++k) {
      const double t = k * kTick;
      current.push_back({t, 0.0, 0.2 * std::sin(4.0 * t) + 0.15 * std::sin(31.0 * t)});
    }
    Write("current.csv", current);
    const CommandResult run = RunCommand(
        "simulate --setup mjcf/voice_coil --replay " + File("current.csv") +
        " --effect cubic_stiffness@stage:coefficient=4e6 --out " + File("run"));
    ASSERT_EQ(run.status, 0) << run.err;
    std::ifstream record(folder_->path() / "run" / "record.csv");
    std::string line;
    std::getline(record, line);
    whole_ = new Rows;
    for (char comma = ','; std::getline(record, line);) {
      std::istringstream cells(line);
      Row row;
      cells >> row.t >> comma >> row.x >> comma >> row.i;
      whole_->push_back(row);
    }
    Write("whole.csv", *whole_);
  }
  static void TearDownTestSuite() {
    delete whole_;
    delete folder_;
  }
  static std::string File(const std::string& name) {
    return "'" + (folder_->path() / name).string() + "'";
  }
  static void Write(const std::string& name, const Rows& rows) {
    std::ofstream file(folder_->path() / name);
    file.precision(12);
    file << "time [s],x [m],i [A]\n";
    const auto cell = [](double value) {
      std::ostringstream text;
      text.precision(12);
      if (!std::isnan(value)) text << value;
      return text.str();
    };
    for (const Row& row : rows) {
      file << row.t << "," << cell(row.x) << "," << cell(row.i) << "\n";
    }
  }
  /// What a command says as JSON, with the setup and a record of that name.
  static json Ask(const std::string& command, const std::string& record,
                  const std::string& more = "") {
    const CommandResult result =
        RunCommand(command + " --setup mjcf/voice_coil --record " + File(record) +
                   more + " --json --out " + File("out_" + command));
    EXPECT_EQ(result.status, 0) << command << " " << record << ": " << result.err;
    return result.status == 0 ? json::parse(result.out) : json();
  }
  /// Of the whole record: asked once for all tests.
  static const json& OfWhole(const std::string& command) {
    static std::map<std::string, json> answers;
    const auto known = answers.find(command);
    if (known != answers.end()) return known->second;
    return answers[command] = Ask(command, "whole.csv");
  }
  /// That all commands take it, say so, and answer what they answer to the whole record.
  static void ExpectSameAnswers(const std::string& name, const Rows& rows,
                                const std::string& note) {
    Write(name, rows);
    const json& whole = OfWhole("compare")["channels"]["x"];
    const json compared = Ask("compare", name);
    EXPECT_THAT(compared["notes"].dump(), HasSubstr(note));
    EXPECT_NEAR(compared["channels"]["x"]["rms"], whole["rms"],
                0.02 * whole["rms"].get<double>());
    const json diagnosed = Ask("diagnose", name);
    EXPECT_THAT(diagnosed["notes"].dump(), HasSubstr(note));
    EXPECT_EQ(diagnosed["detected"], OfWhole("diagnose")["detected"]);
    const json calibrated = Ask("calibrate", name);
    EXPECT_THAT(calibrated["notes"].dump(), HasSubstr(note));
    const json& numbers = OfWhole("calibrate")["numbers"];
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const json& number = calibrated["numbers"][i];
      EXPECT_EQ(number["name"], numbers[i]["name"]);
      EXPECT_NEAR(number["factor"], numbers[i]["factor"],
                  2.0 * numbers[i]["sd"].get<double>())
          << number["name"];
    }
    const json found = Ask("discover", name);
    EXPECT_THAT(found["notes"].dump(), HasSubstr(note));
    ASSERT_FALSE(found["causes"].empty());
    EXPECT_EQ(found["causes"][0]["effect"], "cubic_stiffness");
    EXPECT_NEAR(found["causes"][0]["parameters"]["coefficient"]["value"], 4e6, 4e4);
  }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline Rows* whole_ = nullptr;
};

TEST_F(LackingRecord, WithGapsAndEmptyCells) {
  Rows rows;
  for (int k = 0; k < kSamples; ++k) {
    if ((k >= 2000 && k < 2040) || k == 5000) continue;
    Row row = (*whole_)[static_cast<std::size_t>(k)];
    if (k < 3 || (k >= 3000 && k < 3015)) row.x = kNan;
    if (k >= kSamples - 5) row.i = kNan;
    rows.push_back(row);
  }
  ExpectSameAnswers("gaps.csv", rows, "1 gap of 8.20 ms at 400 ms");
}

TEST_F(LackingRecord, OfASensorThatIsSlowerThanIt) {
  Rows rows = *whole_;
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k].x = rows[k - k % 4].x;
  ExpectSameAnswers("slow.csv", rows, "'x' has a new value only once in 4 samples");
}

TEST_F(LackingRecord, WithJitterAndValuesThatStandForTwo) {
  Rows rows = *whole_;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double early = 0.2 * uniform(random);
    rows[k].t -= early * kTick;
    rows[k].x -= early * ((*whole_)[k].x - (*whole_)[k - 1].x);
    if (uniform(random) < 0.05) rows[k].x = rows[k - 1].x;
  }
  ExpectSameAnswers("twice.csv", rows, "time stamps are irregular");
}

}  // namespace
}  // namespace mjdiag
