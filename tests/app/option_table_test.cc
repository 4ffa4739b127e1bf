// What the absence of an option does: a row for every option of every command, and none
// for what there is not. Where a text says the same as its absence, the command is run
// with it and without it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "app/command_line.h"

namespace mjdiag {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// What an option that is not given does.
struct Absence {
  enum class Kind {
    kSame,      ///< as if `text` were given
    kNothing,   ///< nothing of its kind is added, asked for or written
    kRequired,  ///< one line, exit status 2
  };
  Kind kind = Kind::kNothing;
  std::string text = {};
};

const Absence kNothing{Absence::Kind::kNothing};
const Absence kRequired{Absence::Kind::kRequired};
Absence Same(const std::string& text) { return {Absence::Kind::kSame, text}; }

using Rows = std::map<std::string, Absence>;

Rows operator+(Rows a, const Rows& b) {
  a.insert(b.begin(), b.end());
  return a;
}

const Rows kMachine{{"--setup", kRequired},
                    {"--set", kNothing},
                    {"--fault", kNothing},
                    {"--effect", kNothing},
                    {"--no-friction", Same("--no-friction=false")}};
const Rows kMotion{{"--trajectory", Same("--trajectory default")},
                   {"--replay", kNothing},
                   {"--duration", kNothing},  // all of the trajectory
                   {"--mode", Same("--mode both")},
                   {"--noise", Same("--noise 1")},
                   {"--seed", Same("--seed 1")},
                   {"--linear", Same("--linear=false")}};
const Rows kDiagnosis{{"--filters", kNothing},  // designed on the spot
                      {"--baseline", Same("--baseline=false")},
                      {"--robust", kNothing},
                      {"--nominal-runs", Same("--nominal-runs 5")}};
const Rows kOutput{{"--out", kNothing}, {"--json", kNothing}};
const Rows kReport{{"--report", Same("--report=false")}};

const std::map<std::string, Rows>& Table() {
  static const std::map<std::string, Rows> table{
      {"simulate", kMachine + kMotion + kDiagnosis + kOutput + kReport +
                       Rows{{"--stream", kNothing},
                            {"--stream-for", kNothing},
                            {"--stream-format", kNothing},
                            {"--speed", kNothing},
                            {"--batch", kNothing},
                            {"--twice", kNothing},
                            {"--play", kNothing},
                            {"--mqtt-user", kNothing},
                            {"--mqtt-ca", kNothing},
                            {"--format", Same("--format csv")},
                            {"--log-joints", Same("--log-joints=false")},
                            {"--diagnose", Same("--diagnose=false")},
                            {"--tolerate", Same("--tolerate=false")}}},
      {"init", Rows{{"--plant", kRequired},
                    {"--out", kRequired},
                    {"--json", kNothing},
                    {"--record", kNothing},
                    {"--force", kNothing}}},
      {"linearize", kMachine + kOutput +
                        Rows{{"--plant", kNothing},
                             {"--at", Same("--at rest")},
                             {"--compare", Same("--compare=false")},
                             {"--published", Same("--published=false")}}},
      {"design", kMachine + kDiagnosis + kOutput + kReport +
                     Rows{{"--linear", Same("--linear=false")},
                          {"--method", Same("--method svd")}}},
      {"diagnose", kMachine + kDiagnosis + kOutput + kReport +
                       Rows{{"--record", kRequired},
                            {"--fields", kNothing},
                            {"--linear", Same("--linear=false")}}},
      {"calibrate", kMachine + Rows{{"--out", kRequired},
                                    {"--json", kNothing},
                                    {"--record", kRequired},
                                    {"--linear", Same("--linear=false")}}},
      {"compare", kMachine + kOutput + kReport +
                      Rows{{"--plant", kNothing},
                           {"--fields", kNothing},
                           {"--record", kRequired},
                           {"--open-loop", Same("--open-loop=false")},
                           {"--seed", Same("--seed 1")}}},
      // Without --doubt and --no-doubt the plant says whether it is exact (below).
      {"discover", kMachine + kReport +
                       Rows{{"--plant", kNothing},
                            {"--fields", kNothing},
                            {"--out", kRequired},
                            {"--json", kNothing},
                            {"--record", kRequired},
                            {"--validation", kNothing},
                            {"--records", kNothing},
                            {"--data", kNothing},
                            {"--train-share", Same("--train-share 0.7")},
                            {"--causes", Same("--causes 8")},
                            {"--doubt", Same("--doubt")},
                            {"--estimate-parameters", Same("--estimate-parameters")},
                            {"--no-doubt", kNothing},
                            {"--known", kNothing},
                            {"--without", kNothing},
                            {"--only", kNothing},
                            {"--budget", Same("--budget 60")},
                            {"--seed", Same("--seed 1")}}},
      {"render", kMachine + kMotion + kDiagnosis +
                     Rows{{"--out", kRequired},
                          {"--json", kNothing},
                          {"--record", kNothing},
                          {"--camera", kNothing},
                          {"--width", Same("--width 1280")},
                          {"--height", Same("--height 720")},
                          {"--fps", Same("--fps 30")},
                          {"--speed", Same("--speed 0.02")},
                          {"--from", kNothing},     // from the start
                          {"--to", kNothing},       // to the end
                          {"--amplify", kNothing},  // chosen from the data
                          {"--still", kNothing},
                          {"--frames", Same("--frames=false")},
                          {"--ghost", Same("--ghost=false")},
                          {"--path", kNothing},  // the tool's
                          {"--diagnose", Same("--diagnose=false")}}},
      {"study", kMachine + kOutput + kReport +
                    Rows{{"--preset", kRequired},
                         {"--runs", Same("--runs 200")},
                         {"--seed", Same("--seed 1")},
                         {"--linear", Same("--linear=false")},
                         {"--duration", Same("--duration 0")},
                         {"--every", Same("--every 60")},
                         {"--wear", kNothing},
                         {"--plan", kNothing},
                         {"--resume", kNothing},
                         {"--restart", kNothing},
                         {"--threads", kNothing},  // all of the computer, or the job's
                         {"--patience", kNothing}}},  // of plans in a job only
      {"excite", kMachine + kOutput + kReport +
                     Rows{{"--for", kNothing},
                          {"--record", kNothing},  // of machines without controllers
                          {"--limit", kNothing},
                          {"--max-frequency", Same("--max-frequency 0")},
                          {"--name", Same("--name excite")},
                          {"--budget", kNothing}}},
      {"report", {{"--json", kNothing}}}};
  return table;
}

/// As `--help` lists them, but for --help itself.
std::set<std::string> OptionsOf(const std::string& command) {
  std::istringstream help(RunCommand(command + " --help").out);
  const std::regex option(R"(--[a-z][a-z-]*)");
  std::set<std::string> options;
  for (std::string line; std::getline(help, line);) {
    if (line.rfind("  -", 0) != 0) continue;
    const std::string names = line.substr(2, line.find(' ', 2) - 2);
    for (std::sregex_iterator i(names.begin(), names.end(), option), end; i != end;
         ++i) {
      if (i->str() != "--help") options.insert(i->str());
    }
  }
  return options;
}

/// A record of the motion stage, and one short enough run of each command.
class OptionTable : public ::testing::Test {
 protected:
  void SetUp() override {
    // The stage, reading what it writes.
    fs::copy(fs::path(MJDIAG_SOURCE_DIR) / "mjcf/emps", folder_.path() / "stage",
             fs::copy_options::recursive);
    std::string setup = ReadAll(folder_.path() / "stage/setup.toml");
    const std::size_t begin = setup.find("[record]");
    setup.erase(begin, setup.find("[compare]") - begin);
    const std::string sensor = "[sensors.q]\n";
    setup.insert(setup.find(sensor) + sensor.size(), "noise_power = 1e-16\n");
    std::ofstream(folder_.path() / "stage/setup.toml") << setup;
    const CommandResult measured =
        RunCommand("simulate --setup" + Quoted("stage") + " --duration 4.5 --out" +
                   Quoted("measured"));
    ASSERT_EQ(measured.status, 0) << measured.err;
  }
  std::string Path(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  std::string Quoted(const std::string& name) const { return " '" + Path(name) + "'"; }

  /// With all that is required.
  std::string Base(const std::string& command, const std::string& out) const {
    const std::string record = Quoted("measured/record.csv");
    const std::string to = " --out" + Quoted(out);
    if (command == "report") return "report" + Quoted("measured");
    if (command == "linearize") return "linearize --setup mjcf/ab383" + to;
    if (command == "study") return "study --setup mjcf/ab383 --preset bound" + to;
    if (command == "init") return "init --plant" + Quoted("stage/plant.xml") + to;
    std::string text = command + " --setup" + Quoted("stage") + to;
    if (command == "simulate") text += " --duration 0.2";
    if (command == "render") text += " --duration 0.2 --still 0.1";
    if (command == "diagnose" || command == "calibrate" || command == "compare") {
      text += " --record" + record;
    }
    if (command == "discover") text += " --only coulomb_friction --record" + record;
    return text;
  }

  /// The document, without what no two runs have in common.
  static json Document(const std::string& arguments) {
    const CommandResult result = RunCommand(arguments + " --json");
    EXPECT_LE(result.status, 1) << arguments << "\n" << result.err;
    json document = json::parse(result.out, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << arguments;
    for (const char* key : {"command", "real_time_factor"}) document.erase(key);
    if (document.contains("budget")) document["budget"].erase("used");
    return document;
  }

  const TemporaryFolder folder_;
};

TEST_F(OptionTable, HasARowForEveryOption) {
  for (const auto& [command, rows] : Table()) {
    std::set<std::string> listed;
    for (const auto& [option, absence] : rows) listed.insert(option);
    EXPECT_EQ(listed, OptionsOf(command)) << command;
  }
}

TEST_F(OptionTable, WhatIsRequiredIsMissed) {
  for (const auto& [command, rows] : Table()) {
    for (const auto& [option, absence] : rows) {
      if (absence.kind != Absence::Kind::kRequired) continue;
      const std::regex given(option + " ('[^']*'|[^ ]+)");
      const std::string base = Base(command, "missed");
      const std::string without = std::regex_replace(base, given, "");
      ASSERT_NE(without, base) << option;
      const CommandResult result = RunCommand(without);
      EXPECT_EQ(result.status, 2) << without;
      EXPECT_THAT(result.err, ::testing::HasSubstr(option)) << without;
    }
  }
}

TEST_F(OptionTable, AbsenceIsWhatItSays) {
  for (const auto& [command, rows] : Table()) {
    const bool any = std::ranges::any_of(
        rows, [](const auto& row) { return row.second.kind == Absence::Kind::kSame; });
    if (!any) continue;
    const std::string base = Base(command, command);
    const json absent = Document(base);
    std::string all;
    for (const auto& [option, absence] : rows) {
      if (absence.kind == Absence::Kind::kSame) all += " " + absence.text;
    }
    if (Document(base + all) == absent) continue;
    // One by one, to say which.
    ADD_FAILURE() << base << all;
    for (const auto& [option, absence] : rows) {
      if (absence.kind != Absence::Kind::kSame) continue;
      EXPECT_EQ(Document(base + " " + absence.text), absent)
          << command << " " << absence.text;
    }
  }
}

// Numbers of the plant are in doubt unless it says that it is exact: here the damper is
// another one.
TEST_F(OptionTable, DoubtIsWhatThePlantSays) {
  const CommandResult worn =
      RunCommand("simulate --setup" + Quoted("stage") +
                 " --duration 2.4 --fault zeta=1.2" + " --out" + Quoted("worn"));
  ASSERT_EQ(worn.status, 0) << worn.err;
  const auto numbers = [&](const std::string& setup, const std::string& more) {
    return Document("discover --setup" + setup + " --only coulomb_friction --record" +
                    Quoted("worn/record.csv") + " --out" + Quoted("doubt") +
                    more)["calibration"];
  };
  const std::string stage = Quoted("stage");
  const std::string exact = Quoted("exact");
  fs::copy(folder_.path() / "stage", folder_.path() / "exact",
           fs::copy_options::recursive);
  std::string plant = ReadAll(folder_.path() / "exact/plant.xml");
  const std::string place = "<custom>";
  plant.insert(plant.find(place) + place.size(),
               "<numeric name=\"known\" data=\"0\"/>");
  std::ofstream(folder_.path() / "exact/plant.xml") << plant;

  EXPECT_FALSE(numbers(stage, "").empty());
  EXPECT_TRUE(numbers(stage, " --no-doubt").empty());
  EXPECT_TRUE(numbers(exact, "").empty());
  EXPECT_FALSE(numbers(exact, " --doubt").empty());
  EXPECT_FALSE(numbers(exact, " --estimate-parameters").empty());
}

}  // namespace
}  // namespace mjdiag
