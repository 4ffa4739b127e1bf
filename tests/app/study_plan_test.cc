// Studies of one's own, as users run them, and end them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/command_line.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kBonderPlan = R"(schema = "mjdiag.plan/1"
name = "killed"
setup = ")" MJDIAG_SOURCE_DIR R"(/mjcf/ab383"
linear = true
trajectories = ["xyz"]
duration = 0.1
method = "random"
points = 120
[keep]
records = ["x", "u_x"]
features = ["x"]
segment = 256
[[axis]]
fault = "eta_x"
from = 0.99
to = 0.9
)";

/// Starts the study, and kills it when its journal has got that many bytes more.
void KillWhileItRuns(const std::string& plan, const fs::path& folder,
                     std::uintmax_t bytes) {
  const fs::path journal = folder / "runs.journal";
  const std::uintmax_t before = fs::exists(journal) ? fs::file_size(journal) : 0;
  std::fflush(stdout);  // or the child says it again
  const pid_t child = fork();
  if (child == 0) {
    if (std::freopen("/dev/null", "w", stdout) == nullptr) _exit(126);
    execl(MJDIAG_COMMAND, MJDIAG_COMMAND, "study", "--plan", plan.c_str(), "--out",
          folder.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (fs::exists(journal) && fs::file_size(journal) >= before + bytes) {
      kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(WIFSIGNALED(status)) << "it had ended before it was killed";
  EXPECT_FALSE(fs::exists(folder / "dataset.h5"));
}

TEST(StudyPlanCommand, GoesOnAfterThreeKillsWithTheSameBits) {
  const TemporaryFolder folder;
  const std::string plan = folder.Write("plan.toml", kBonderPlan);
  const std::string whole = (folder / "whole").string();
  const CommandResult at_once = RunCommand("study --plan " + plan + " --out " + whole);
  ASSERT_EQ(at_once.status, 0) << at_once.err;
  EXPECT_THAT(at_once.out, AllOf(HasSubstr("120 of 120 runs"), HasSubstr("Runs")));
  const fs::path killed = folder / "killed";
  // A run has 10 kB and more.
  for (const std::uintmax_t bytes : {60'000U, 200'000U, 130'000U}) {
    KillWhileItRuns(plan, killed, bytes);
  }
  const CommandResult rest =
      RunCommand("study --resume --plan " + plan + " --out " + killed.string());
  EXPECT_EQ(rest.status, 0) << rest.err;
  EXPECT_THAT(rest.out, HasSubstr("of which were there"));
  const auto document = nlohmann::json::parse(ReadAll(killed / "study.json"));
  EXPECT_EQ(document.at("runs"), 120);
  EXPECT_EQ(document.at("plan"), "killed");
  if (document.at("dataset").is_null()) GTEST_SKIP() << "built without HDF5";
  const std::string bytes = ReadAll(killed / "dataset.h5");
  EXPECT_GT(bytes.size(), 1'000'000u);
  EXPECT_TRUE(bytes == ReadAll(folder / "whole/dataset.h5"));
  EXPECT_THAT(ReadAll(killed / "study.log"), HasSubstr("of 120 runs"));

  // Another plan in that folder; one with a typing error.
  const std::string other =
      folder.Write("other.toml", std::string(kBonderPlan) + "#\n");
  const CommandResult refused =
      RunCommand("study --plan " + other + " --out " + killed.string());
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("runs.journal"), HasSubstr("another plan")));
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
}

TEST(StudyPlanCommand, AnswersAPlanThatAsksSomethingAsThePresetDoes) {
  const auto tables = [](const std::string& of) {
    const CommandResult result = RunCommand("study " + of + " --json");
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out)["tables"];
  };
  EXPECT_EQ(tables("--plan mjcf/ab383/plans/bound.toml"),
            tables("--setup mjcf/ab383 --preset bound"));
}

TEST(StudyPlanCommand, SaysWhereAPlanIsWrong) {
  const TemporaryFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  const auto refused = [&](const std::string& arguments) {
    const CommandResult result = RunCommand("study " + arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  std::string text = kBonderPlan;
  text.replace(text.find("points"), 6, "pionts");
  const std::string typo = folder.Write("typo.toml", text);
  EXPECT_THAT(refused("--plan " + typo + out),
              AllOf(HasSubstr("typo.toml"), HasSubstr("points")));
  const std::string plan = folder.Write("plan.toml", kBonderPlan);
  EXPECT_THAT(refused("--plan " + plan + " --preset table2" + out),
              AllOf(HasSubstr("--preset"), HasSubstr("a key of the plan")));
  EXPECT_THAT(refused("--plan " + plan), HasSubstr("--out"));
  EXPECT_THAT(refused(out.substr(1)), HasSubstr("--plan"));
  EXPECT_THAT(refused("--preset table2"), HasSubstr("--setup"));
  EXPECT_FALSE(fs::exists(folder / "out/dataset.h5"));
}

}  // namespace
}  // namespace mjdiag
