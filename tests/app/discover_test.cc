// What `mjdiag discover` says while it runs, and how it is asked to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "app/command_line.h"
#include "support/sanitizers.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// Before something is taken for stuck.
constexpr auto kLongest = std::chrono::minutes(test::kSanitized ? 10 : 1);

/// A record of the bonder with two effects that it takes long to find.
class DiscoverCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    const CommandResult measured = RunCommand(
        "simulate --setup mjcf/ab383 --duration 0.2 "
        "--effect coulomb_friction@X:force=4 "
        "--effect force_ripple@Y:amplitude=0.5,period=0.024 --out '" +
        folder_.path().string() + "'");
    ASSERT_EQ(measured.status, 0) << measured.err;
  }
  std::string Arguments(const std::string& more) const {
    const std::string folder = folder_.path().string();
    return "discover --setup mjcf/ab383 --record '" + folder +
           "/record.csv' --json --out '" + folder + "/found' " + more;
  }
  /// Its process, with its output in files of the folder.
  pid_t Begin(const std::string& more) const {
    const pid_t child = fork();
    if (child == 0) {
      const std::string line =
          "cd '" MJDIAG_SOURCE_DIR "' && exec '" MJDIAG_COMMAND "' " + Arguments(more) +
          " >'" + Path("out") + "' 2>'" + Path("err") + "'";
      execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      _exit(127);
    }
    return child;
  }
  /// Once so many lines tell how far it is, or time is up.
  void WaitForLines(int count) const {
    const auto begin = std::chrono::steady_clock::now();
    while (std::ranges::count(ReadAll(Path("err")), '\n') < count &&
           std::chrono::steady_clock::now() - begin < kLongest) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  std::string Path(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  const TemporaryFolder folder_;
};

TEST_F(DiscoverCommand, TellsEveryFewSecondsHowFarItIs) {
  const pid_t child = Begin("--budget 100000");
  WaitForLines(2);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const std::string told = ReadAll(Path("err"));
  const std::regex line(R"(\d+ s: [^;\n]+; so far: [^\n]+\n)");
  std::vector<int> seconds;
  for (std::sregex_iterator i(told.begin(), told.end(), line), end; i != end; ++i) {
    seconds.push_back(std::stoi(i->str()));
  }
  ASSERT_GE(seconds.size(), 2U) << told;
  EXPECT_GE(seconds.front(), 5);
  for (std::size_t i = 1; i < seconds.size(); ++i) {
    EXPECT_GE(seconds[i], seconds[i - 1] + 4);
  }
  EXPECT_EQ(std::regex_replace(told, line, ""), "");
}

TEST_F(DiscoverCommand, SaysWhatItsBudgetCut) {
  const CommandResult result = RunCommand(Arguments("--budget 0.01 --only eta_x"));
  const json document = json::parse(result.out);
  EXPECT_EQ(document["budget"]["limit"], 0.01);
  EXPECT_THAT(document["notes"].dump(), HasSubstr("ended by its budget of 0.01 s"));
}

TEST_F(DiscoverCommand, EndsAfterASignalWithTheAnswerItHas) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t child = Begin("--budget 100000");
    WaitForLines(1);
    const auto asked = std::chrono::steady_clock::now();
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_LT(std::chrono::steady_clock::now() - asked, kLongest);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 128 + signal);
    const json document = json::parse(ReadAll(Path("found/discovery.json")));
    EXPECT_EQ(document["budget"]["stopped"], true);
    EXPECT_THAT(document["notes"].dump(), HasSubstr("it was stopped"));
    EXPECT_EQ(json::parse(ReadAll(Path("out"))), document);
    std::filesystem::remove_all(Path("found"));
    std::filesystem::remove(Path("err"));
  }
}

TEST_F(DiscoverCommand, EndsAtOnceAfterASecondSignal) {
  const pid_t child = Begin("--budget 100000");
  WaitForLines(1);
  // Both before anything has been written.
  kill(child, SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
  EXPECT_FALSE(std::filesystem::exists(Path("found/discovery.json")));
}

TEST_F(DiscoverCommand, RefusesChoicesThatMeanNothing) {
  const CommandResult unknown = RunCommand(Arguments("--without encoder_scal"));
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("encoder_scale"));
  EXPECT_EQ(RunCommand(Arguments("--only eta_x --without drive")).status, 2);
  EXPECT_EQ(RunCommand(Arguments("--budget 0")).status, 2);
}

}  // namespace
}  // namespace mjdiag
