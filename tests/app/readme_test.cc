// The commands of README.md and of its tour, as they stand there, in a folder that has
// nothing but the machines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "app/command_line.h"

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

/// Puts links to all records of a folder beside the machines.
void LinkFiles(const fs::path& from, const fs::path& to) {
  for (const auto& entry : fs::directory_iterator(from)) {
    const std::string kind = entry.path().extension().string();
    if (kind != ".csv" && kind != ".mat") continue;
    fs::create_symlink(entry.path(), to / entry.path().filename());
  }
}

TEST(Readme, CommandsDoWhatTheySay) {
  const TemporaryFolder folder;
  const fs::path root(MJDIAG_SOURCE_DIR);
  fs::create_symlink(root / "mjcf", folder.path() / "mjcf");
  const auto emps = DataFolder("MJDIAG_EMPS_DATA");
  const auto servo = DataFolder("MJDIAG_SERVO_DATA");
  if (emps) LinkFiles(*emps, folder.path());
  if (servo) LinkFiles(*servo, folder.path());
  const auto panda = DataFolder("MJDIAG_PANDA_DATA");
  if (panda) LinkFiles(*panda, folder.path());

  std::vector<std::string> commands = CommandsOf("README.md");
  ASSERT_GE(commands.size(), 6u);
  const std::vector<std::string> tour = CommandsOf("docs/tour.md");
  ASSERT_GE(tour.size(), 18u);
  commands.insert(commands.end(), tour.begin(), tour.end());
  int typed = 0;
  for (std::string command : commands) {
    // Studies take many minutes; tests of their own type them with fewer runs.
    if (command.rfind("mjdiag study", 0) == 0) continue;
    // What needs measured data that are not here.
    if (!emps && command.find("DATA_EMPS") != std::string::npos) continue;
    if (!servo && command.find("mjcf/servo") != std::string::npos) continue;
    if (!panda && command.find("mjcf/panda") != std::string::npos) continue;
    // The walk of docs/own-machine.md types it with the same records.
    if (command.rfind("mjdiag discover --setup mjcf/servo", 0) == 0) continue;
    // Other tests wait for the answers of a minute, and for the best motion.
    command = std::regex_replace(command, std::regex("--budget [0-9]+"), "--budget 10");
    // Beside other tests the clock goes faster.
    command = std::regex_replace(command, std::regex("^mjdiag discover "),
                                 "mjdiag discover --budget 300 ");
    command = std::regex_replace(command, std::regex("^mjdiag excite "),
                                 "mjdiag excite --budget 5 ");
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
  if (emps) {
    const auto document = nlohmann::json::parse(
        ReadAll(folder.path() / "out/found/discovery.json"), nullptr, false);
    EXPECT_THAT(document["causes"].dump(), testing::HasSubstr("friction"));
  }
}

}  // namespace
}  // namespace mjdiag
