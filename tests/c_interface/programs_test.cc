// The diagnosis of programs in C against that of the command, to the last bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "c_interface/monitor_bench.h"
#include "mjdiag/diagnosis/diagnosis_json.h"
#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

constexpr const char* kWorn = "Detected: zeta_x = 1.2.\n";

void Cut(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  ASSERT_NE(begin, std::string::npos) << from;
  const std::size_t end = text.find(to, begin);
  ASSERT_NE(end, std::string::npos) << to;
  text.erase(begin, end - begin);
}

class CPrograms : public test::BonderBench {
 protected:
  /// Filters of the linear or nonlinear bonder, made once for all tests.
  static std::string Filters(bool linear) {
    static const TemporaryFolder folder;
    const fs::path out = folder / (linear ? "linear" : "nonlinear");
    if (!fs::exists(out)) {
      EXPECT_EQ(RunCommand(std::string("design --setup mjcf/ab383 ") +
                           (linear ? "--linear --out " : "--out ") + out.string())
                    .status,
                0);
    }
    return (out / "filters.json").string();
  }
  /// What `mjdiag <arguments>` says and leaves in the folder "command".
  std::string Command(const std::string& arguments) const {
    const CommandResult result =
        RunCommand(arguments + " --out '" + Path("command") + "'");
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result.out;
  }
  /// What a program prints.
  std::string Run(const std::string& program,
                  const std::vector<std::string>& arguments) const {
    std::string line = "'" MJDIAG_C_PROGRAMS "/" + program + "'";
    for (const std::string& argument : arguments) line += " '" + argument + "'";
    const std::string out = Path("out");
    const std::string err = Path("err");
    EXPECT_EQ(std::system((line + " >'" + out + "' 2>'" + err + "'").c_str()), 0)
        << line << "\n"
        << ReadAll(err);
    return ReadAll(out);
  }
  /// A copy of the bonder's setup without controllers: records drive it.
  std::string OpenLoop() const {
    fs::copy(kSetup, folder_ / "open");
    std::string text = Read("open/setup.toml");
    Cut(text, "default_trajectory", "\n");
    Cut(text, "[axes.x]", "[disturbances.gamma]");
    Cut(text, "[trajectories.multi]", "[diagnosis]");
    Cut(text, "trajectories = [", "\n");
    return fs::path(folder_.Write("open/setup.toml", text)).parent_path().string();
  }
};

TEST_F(CPrograms, WatchWhatMjdiagControlsAsTheCommandDoes) {
  const std::string filters = Filters(false);
  EXPECT_EQ(Run("watch_attached",
                {kSetup, filters, "xyz", "zeta_x", "1.2", Path("diagnosis.json")}),
            kWorn);
  EXPECT_THAT(Command("simulate --setup mjcf/ab383 --trajectory xyz --fault zeta_x=1.2 "
                      "--diagnose --filters " +
                      filters),
              HasSubstr(kWorn));
  EXPECT_EQ(Read("diagnosis.json"), Read("command/diagnosis.json"));
}

TEST_F(CPrograms, ListenToTheirOwnControllersAsTheCommandDoes) {
  const std::string filters = Filters(false);
  EXPECT_EQ(Run("own_loop", {kSetup, filters, "zeta_x", "1.2", "0", "steps",
                             Path("record.csv"), Path("diagnosis.json")}),
            kWorn);
  // The same machine, driven by what the program commanded.
  EXPECT_THAT(
      Command("simulate --setup '" + OpenLoop() + "' --replay '" + Path("record.csv") +
              "' --noise 0 --fault zeta_x=1.2 --diagnose --filters " + filters),
      HasSubstr(kWorn));
  EXPECT_EQ(Read("diagnosis.json"), Read("command/diagnosis.json"));
}

TEST_F(CPrograms, ListenFromTheirControlCallbackToo) {
  for (const char* loop : {"steps", "callback"}) {
    EXPECT_EQ(Run("own_loop", {kSetup, Filters(false), "zeta_x", "1.2", "2e-8", loop,
                               Path(std::string(loop) + ".csv"),
                               Path(std::string(loop) + ".json")}),
              kWorn);
  }
  EXPECT_EQ(Read("steps.csv"), Read("callback.csv"));
  EXPECT_EQ(Read("steps.json"), Read("callback.json"));

  Command("diagnose --setup mjcf/ab383 --record '" + Path("steps.csv") +
          "' --filters " + Filters(false));
  json offline = ReadJson("command/diagnosis.json");
  offline.erase("command");
  offline.erase("record");
  EXPECT_EQ(ReadJson("steps.json"), offline);
}

TEST_F(CPrograms, FeedSamplesWithoutMujocoToTheSameBits) {
  for (const bool linear : {true, false}) {
    const std::string filters = Filters(linear);
    EXPECT_THAT(
        Command("simulate --setup mjcf/ab383 --trajectory xyz --fault "
                "zeta_x=1.2 --diagnose " +
                std::string(linear ? "--linear " : "") + "--filters " + filters),
        HasSubstr(kWorn));
    EXPECT_EQ(Run("fed", {kSetup, filters, "0", Path("command/record.csv"),
                          Path("diagnosis.json")}),
              kWorn);
    EXPECT_EQ(Read("diagnosis.json"), Read("command/diagnosis.json"));
  }
}

TEST_F(CPrograms, TakeTheMachineAsLinearIfTheySaySo) {
  Command(
      "simulate --setup mjcf/ab383 --trajectory xyz --fault zeta_x=1.2 --diagnose "
      "--linear --filters " +
      Filters(false));
  EXPECT_EQ(Run("fed", {kSetup, Filters(false), "1", Path("command/record.csv"),
                        Path("diagnosis.json")}),
            kWorn);
  EXPECT_EQ(Read("diagnosis.json"), Read("command/diagnosis.json"));
}

TEST_F(CPrograms, NeedNoSetupForTheResiduals) {
  const std::string filters = Filters(true);
  Command("simulate --setup mjcf/ab383 --trajectory xyz --linear --fault zeta_x=1.2");
  EXPECT_THAT(Run("fed", {"-", filters, "0", Path("command/record.csv"),
                          Path("diagnosis.json")}),
              HasSubstr("zeta_x = 1."));
  const Record record = ReadRecord(folder_ / "command" / "record.csv");
  EXPECT_EQ(
      Read("diagnosis.json"),
      DiagnosisJson(Conclude(RecordDiagnosis(ReadFilters(filters), record))) + "\n");
}

}  // namespace
}  // namespace mjdiag
