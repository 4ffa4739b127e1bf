// A motion beside a measured one, of an arm whose controllers are not known. Its records are
// of others and not in this repository: the folder is named by MJDIAG_PANDA_DATA, see
// docs/own-machine.md.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/command_line.h"

namespace mjdiag {
namespace {

TEST(ExciteCommand, WritesAMotionOfAnArmBesideTheMeasuredOne) {
  const char* data = std::getenv("MJDIAG_PANDA_DATA");
  const std::string record = std::string(data ? data : "") + "/exciting_motion.csv";
  if (!std::filesystem::exists(record)) {
    GTEST_SKIP() << "no data of the arm: MJDIAG_PANDA_DATA names no folder with "
                    "exciting_motion.csv";
  }
  const TemporaryFolder folder;
  const CommandResult done =
      RunCommand("excite --setup mjcf/panda --record '" + record + "' --budget 1 " +
                 "--limit joint1:velocity=1.5 --report --name next --out '" +
                 folder.path().string() + "'");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, ::testing::HasSubstr("condition number"));
  const nlohmann::json answer =
      nlohmann::json::parse(ReadAll(folder.path() / "excitation.json"));
  // The arm's 43 inertial base parameters, friction of two kinds at seven joints, and the
  // rotors of five: what turns with the first two is in the links.
  EXPECT_EQ(answer["numbers"].size(), 43u + 14u + 5u);
  EXPECT_LE(answer["joints"]["joint1"]["peaks"]["velocity"], 1.51);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "report.html"));
  const std::string motion = ReadAll(folder.path() / "next.csv");
  EXPECT_THAT(motion, ::testing::HasSubstr("joint7 [rad]"));
}

TEST(ExciteCommand, SaysWhatAMachineWithoutControllersNeeds) {
  const auto complaint = [](const std::string& arguments) {
    const CommandResult done = RunCommand("excite --setup mjcf/" + arguments);
    EXPECT_EQ(done.status, 2) << done.err;
    return done.err;
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(complaint("panda"), HasSubstr("--record"));
  EXPECT_THAT(complaint("panda --record none.csv"), HasSubstr("none.csv"));
  EXPECT_THAT(complaint("panda --record none.csv --for friction"),
              HasSubstr("no --for"));
  EXPECT_THAT(complaint("ab383 --record none.csv"), HasSubstr("controllers"));
}

// Held for longer than its budget it goes on where it was.
TEST(ExciteCommand, HasABudgetOfWork) {
  constexpr double kBudget = 2.0;  // s
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c",
          "exec '" MJDIAG_COMMAND "' excite --setup '" MJDIAG_SOURCE_DIR
          "/mjcf/ab383' --budget 2 >/dev/null 2>&1",
          nullptr);
    _exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(child, SIGSTOP);
  std::this_thread::sleep_for(std::chrono::duration<double>(1.5 * kBudget));
  kill(child, SIGCONT);
  int status = 0;
  rusage used{};
  ASSERT_EQ(wait4(child, &status, 0, &used), child);
  EXPECT_EQ(status, 0);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  EXPECT_GE(seconds(used.ru_utime) + seconds(used.ru_stime), kBudget);
}

}  // namespace
}  // namespace mjdiag
