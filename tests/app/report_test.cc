// Reports of run folders, as users make them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "app/command_line.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A folder with the page of a comparison, which takes least time.
class ReportCommand : public ::testing::Test {
 protected:
  CommandResult Compare(const std::string& more) const {
    return RunCommand("compare --setup mjcf/ab383 --record mjcf/ab383/example.csv " +
                      more + " --out '" + Folder() + "'");
  }
  std::string Folder() const { return (folder_ / "run").string(); }
  std::string Refused(const std::string& folder) const {
    const CommandResult result = RunCommand("report '" + folder + "'");
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  }
  /// Names of the files in the folder.
  std::set<std::string> Files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(Folder())) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }
  const TemporaryFolder folder_;
};

TEST_F(ReportCommand, IsTheSameAtTheEndOfTheRunAndLater) {
  ASSERT_EQ(Compare("--report").status, 0);
  const std::string report = ReadAll(Folder() + "/report.html");
  EXPECT_THAT(report, AllOf(HasSubstr("Measured against simulated"),
                            HasSubstr("compare --setup mjcf/ab383")));
  fs::remove(Folder() + "/report.html");
  const CommandResult made = RunCommand("report '" + Folder() + "' --json");
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(ReadAll(Folder() + "/report.html"), report);
  const auto document = nlohmann::json::parse(made.out);
  EXPECT_EQ(document["schema"], "mjdiag.report/1");
  EXPECT_EQ(document["report"], Folder() + "/report.html");
  EXPECT_EQ(document["bytes"], report.size());
}

TEST_F(ReportCommand, IsOnlyMadeWhenItIsWanted) {
  ASSERT_EQ(Compare("").status, 0);
  EXPECT_EQ(Files(), (std::set<std::string>{"compare.json", "compare.page.json"}));
}

TEST_F(ReportCommand, RefusesAFolderWithoutAPage) {
  EXPECT_THAT(Refused((folder_ / "none").string()), HasSubstr("no such folder"));
  EXPECT_THAT(Refused(folder_.path().string()), HasSubstr(".page.json"));
  EXPECT_EQ(folder_.size(), 0);
}

TEST_F(ReportCommand, NamesTheFileThatIsBrokenAndWritesNothing) {
  ASSERT_EQ(Compare("").status, 0);
  const std::string page = Folder() + "/compare.page.json";
  const std::string whole = ReadAll(page);
  std::ofstream(page) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT(Refused(Folder()),
              AllOf(HasSubstr("compare.page.json"), HasSubstr("expected")));
  std::ofstream(page) << whole;
  std::ofstream(Folder() + "/clip.mp4") << "half a clip";
  EXPECT_THAT(Refused(Folder()), AllOf(HasSubstr("clip.mp4"), HasSubstr("expected")));
  EXPECT_EQ(Files(),
            (std::set<std::string>{"clip.mp4", "compare.json", "compare.page.json"}));
}

TEST_F(ReportCommand, DoesNotLoseTheResultsToAFileThatIsBroken) {
  fs::create_directories(Folder());
  std::ofstream(Folder() + "/clip.mp4") << "half a clip";
  const CommandResult result = Compare("--report");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("clip.mp4"));
  EXPECT_EQ(Files(),
            (std::set<std::string>{"clip.mp4", "compare.json", "compare.page.json"}));
}

TEST_F(ReportCommand, NeedsAFolder) {
  const CommandResult result =
      RunCommand("compare --setup mjcf/ab383 --record mjcf/ab383/example.csv --report");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("--out"));
}

}  // namespace
}  // namespace mjdiag
