// The commands of README.md and of its tour, as they stand there, in a folder that has
// nothing but the machines and the begins of measured records.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "app/command_line.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// Lines of code blocks that begin with "mjdiag", with what goes on behind a backslash.
std::vector<std::string> CommandsOf(const fs::path& page) {
  std::istringstream text(ReadAll(fs::path(MJDIAG_SOURCE_DIR) / page));
  std::vector<std::string> commands;
  bool goes_on = false;
  for (std::string line; std::getline(text, line);) {
    const bool begins = line.rfind("    mjdiag ", 0) == 0;
    if (begins) commands.emplace_back();
    if (!begins && !goes_on) continue;
    goes_on = line.ends_with("\\");
    commands.back() += line.substr(4) + "\n";
  }
  return commands;
}

std::optional<fs::path> DataFolder(const char* variable) {
  const char* folder = std::getenv(variable);
  if (folder == nullptr || !fs::exists(folder)) return std::nullopt;
  return fs::canonical(folder);
}

/// Of a record of others the first samples, with the columns that its file has.
void WriteBegin(const fs::path& from, const fs::path& to) {
  constexpr Eigen::Index kSamples = 5000;
  if (from.extension() == ".csv") {
    std::ifstream whole(from);
    std::ofstream begin(to);
    std::string line;
    for (Eigen::Index k = 0; k <= kSamples && std::getline(whole, line); ++k) {
      begin << line << "\n";
    }
    return;
  }
  const auto source = OpenRecordSource(from);
  Record begin(1.0);
  for (std::size_t i = 0; i < source->columns().size(); ++i) {
    const SourceColumn& column = source->columns()[i];
    const Eigen::VectorXd all =
        source->Read(std::vector<std::size_t>{i}, MissingCells::kRefused).at(0);
    if (all.size() < kSamples) continue;  // constants of the bench
    begin.Add({column.name, column.unit.value_or("1"), all.head(kSamples)});
  }
  WriteRecord(to, begin, RecordFormat::kMat5);
}

/// Puts the begins of all records of a folder beside the machines.
void WriteBegins(const fs::path& from, const fs::path& to) {
  for (const auto& entry : fs::directory_iterator(from)) {
    const std::string kind = entry.path().extension().string();
    if (kind != ".csv" && kind != ".mat") continue;
    WriteBegin(entry.path(), to / entry.path().filename());
  }
}

/// What takes long made short: other tests wait for the answers of whole records, of a
/// minute, and for the best motion.
std::string Shortened(const std::string& command) {
  const std::pair<const char*, const char*> shorter[] = {
      {"^(mjdiag simulate .*)( --out out/drag)", "$1 --duration 0.1$2"},
      {"^mjdiag discover ", "mjdiag discover --budget 300 "},
      {"^(mjdiag discover .*mjcf/emps )", "$1--only coulomb_friction "},
      {"^mjdiag excite ", "mjdiag excite --budget 2 "}};
  std::string text = command;
  for (const auto& [from, to] : shorter) {
    text = std::regex_replace(text, std::regex(from), to);
  }
  return text;
}

TEST(Readme, CommandsDoWhatTheySay) {
  const TemporaryFolder folder;
  const fs::path root(MJDIAG_SOURCE_DIR);
  fs::create_symlink(root / "mjcf", folder.path() / "mjcf");
  const auto emps = DataFolder("MJDIAG_EMPS_DATA");
  const auto servo = DataFolder("MJDIAG_SERVO_DATA");
  if (emps) WriteBegins(*emps, folder.path());
  if (servo) WriteBegins(*servo, folder.path());
  const auto panda = DataFolder("MJDIAG_PANDA_DATA");
  if (panda) WriteBegins(*panda, folder.path());

  std::vector<std::string> commands = CommandsOf("README.md");
  ASSERT_GE(commands.size(), 6u);
  const std::vector<std::string> tour = CommandsOf("docs/tour.md");
  ASSERT_GE(tour.size(), 18u);
  commands.insert(commands.end(), tour.begin(), tour.end());
  std::set<std::string> met;
  int typed = 0;
  for (std::string command : commands) {
    if (!met.insert(command).second) continue;
    // Studies take many minutes; tests of their own type them with fewer runs.
    if (command.rfind("mjdiag study", 0) == 0) continue;
    // What needs measured data that are not here.
    if (!emps && command.find("DATA_EMPS") != std::string::npos) continue;
    if (!servo && command.find("mjcf/servo") != std::string::npos) continue;
    if (!panda && command.find("mjcf/panda") != std::string::npos) continue;
    // The walk of docs/own-machine.md types it with the same records.
    if (command.rfind("mjdiag discover --setup mjcf/servo", 0) == 0) continue;
    command = Shortened(command);
    // FOLDER is where the reader has the records of the servo.
    if (const auto at = command.find(" FOLDER"); at != std::string::npos) {
      command.replace(at, 7, " '" + servo->string() + "'");
    }
    const std::string log = (folder.path() / "log").string();
    const std::string line = "cd '" + folder.path().string() +
                             "' && mjdiag() { '" MJDIAG_COMMAND "' \"$@\"; } && { " +
                             command + "} >'" + log + "' 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << command << ReadAll(log);
    ++typed;
  }
  EXPECT_GE(typed, 16);
  // What later commands, and the text, say is there.
  for (const char* file : {"out/worn/diagnosis.json", "out/worn/report.html",
                           "out/clip/clip.mp4", "out/calibrated/setup.toml",
                           "out/filters/filters.json", "out/drag/report.html"}) {
    EXPECT_TRUE(fs::exists(folder.path() / file)) << file;
  }
  const auto causes_of = [&](const char* file) {
    const auto document =
        nlohmann::json::parse(ReadAll(folder.path() / file), nullptr, false);
    return document["causes"].dump();
  };
  EXPECT_THAT(causes_of("out/drag/discovery.json"), testing::HasSubstr("drag"));
  if (emps) {
    EXPECT_THAT(causes_of("out/found/discovery.json"), testing::HasSubstr("friction"));
  }
}

}  // namespace
}  // namespace mjdiag
