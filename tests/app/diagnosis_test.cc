// The commands design, diagnose, simulate --diagnose and study, as users run them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "app/command_line.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kLinear = "--setup mjcf/ab383 --linear ";

json JsonOf(const std::string& arguments) {
  const CommandResult result = RunCommand(arguments + " --json");
  EXPECT_EQ(result.status, 0) << result.err;
  return json::parse(result.out);
}

/// The one line on stderr of a command that is refused with status 2.
std::string Refused(const std::string& arguments) {
  const CommandResult result = RunCommand(arguments);
  EXPECT_EQ(result.status, 2) << arguments << "\n" << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  return result.err;
}

class Diagnosis : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  /// Filters of the linear plant, made once for all tests of this process.
  static std::string Filters() {
    static const TemporaryFolder folder;
    const std::string out = (folder.path() / "design").string();
    if (!fs::exists(out)) {
      EXPECT_EQ(RunCommand(std::string("design ") + kLinear + "--out " + out).status,
                0);
    }
    return out + "/filters.json";
  }
  /// A copy of the bonder's setup with a piece of a file replaced.
  std::string Changed(const std::string& file, const std::string& from,
                      const std::string& to) const {
    const fs::path copy = folder_.path() / "changed";
    fs::create_directories(copy);
    fs::copy(fs::path(MJDIAG_SOURCE_DIR) / "mjcf" / "ab383", copy,
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    std::string text = ReadAll(copy / file);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    std::ofstream(copy / file) << text;
    return copy.string();
  }
  const TemporaryFolder folder_;
};

double ValueOf(const json& diagnosis, const std::string& fault) {
  for (const json& entry : diagnosis["faults"]) {
    if (entry["name"] == fault) return entry["value"];
  }
  ADD_FAILURE() << "no " << fault;
  return 0.0;
}

TEST_F(Diagnosis, OfARecordEqualsTheOneInsideTheCallbackToTheLastBit) {
  const std::string filters = Filters();
  const std::string out = Path("run");
  const std::string at_once =
      "--duration 0.5 --fault zeta_x=1.005 --fault eta_z=0.999 --diagnose --filters " +
      filters + " --out " + out;
  const std::string afterwards = "diagnose --setup mjcf/ab383 --filters " + filters +
                                 " --record " + out + "/record.csv";
  for (const char* plant : {"--linear ", "--no-friction "}) {
    ASSERT_EQ(RunCommand(std::string("simulate --setup mjcf/ab383 ") + plant + at_once)
                  .status,
              0);
    const json inside = json::parse(ReadAll(out + "/diagnosis.json"));
    json offline = JsonOf(afterwards);
    offline.erase("command");
    offline.erase("record");
    EXPECT_EQ(inside, offline);
  }
}

TEST_F(Diagnosis, FindsTheFaultAndItsSize) {
  const json document =
      JsonOf(std::string("simulate ") + kLinear +
             "--fault zeta_x=1.005 --fault eta_z=0.9999 --diagnose --filters " +
             Filters())["diagnosis"];
  EXPECT_EQ(document["schema"], "mjdiag.diagnosis/1");
  EXPECT_TRUE(document["detected"]);
  EXPECT_LT(document["first_detection"].get<double>(), 0.05);
  EXPECT_FALSE(document["lasting_since"].is_null());
  EXPECT_NEAR(ValueOf(document, "zeta_x"), 1.005, 5e-5);
  EXPECT_NEAR(ValueOf(document, "eta_z"), 0.9999, 1e-6);
  for (const json& fault : document["faults"]) {
    EXPECT_EQ(fault["detected"], fault["name"] == "zeta_x" || fault["name"] == "eta_z")
        << fault;
  }
}

TEST_F(Diagnosis, SaysThatAHealthyMachineIsHealthy) {
  const json document = JsonOf(std::string("simulate ") + kLinear +
                               "--seed 11 --diagnose --filters " + Filters());
  EXPECT_FALSE(document["diagnosis"]["detected"]);
  EXPECT_TRUE(document["diagnosis"]["first_detection"].is_null());
  EXPECT_TRUE(document["diagnosis"]["disturbance"]["peaks"].empty());
}

// Nothing but the noise of its encoders moves it, through its controllers.
TEST_F(Diagnosis, SaysThatAHealthyMachineThatIsHeldInItsPlaceIsHealthy) {
  const std::string setup = Changed("setup.toml", "[trajectories.multi]",
                                    "[trajectories.hold]\n"
                                    "duration = 10.0\n"
                                    "period = 0.5\n"
                                    "moves = [{ at = 0.005, by = { x = 1e-9 } },\n"
                                    "         { at = 0.030, by = { x = -1e-9 } }]\n\n"
                                    "[trajectories.multi]");
  // With the second one a pass is behind when the readings of the start are not kept any
  // more.
  for (const char* seed : {"1", "15"}) {
    const json document =
        JsonOf("simulate --linear --trajectory hold --diagnose --seed " +
               std::string(seed) + " --setup " + setup);
    EXPECT_FALSE(document["diagnosis"]["detected"]) << document["diagnosis"]["faults"];
  }
}

TEST_F(Diagnosis, CallsTenfoldNoiseNoiseAndNotATone) {
  const json document =
      JsonOf(std::string("simulate ") + kLinear + "--noise 10 --diagnose --filters " +
             Filters())["diagnosis"];
  EXPECT_TRUE(document["disturbance"]["noise_raised"]);
  EXPECT_TRUE(document["disturbance"]["peaks"].empty());
  EXPECT_NEAR(document["disturbance"]["noise_ratio"].get<double>(), 100.0, 15.0);
}

TEST_F(Diagnosis, FindsTheTonesOfADisturbance) {
  const json document =
      JsonOf(std::string("simulate ") + kLinear +
             "--fault gamma=0.01 --diagnose --filters " + Filters())["diagnosis"];
  std::vector<double> frequencies;
  for (const json& peak : document["disturbance"]["peaks"]) {
    frequencies.push_back(std::round(peak["frequency"].get<double>()));
  }
  EXPECT_THAT(frequencies, ::testing::ElementsAre(100.0, 300.0, 750.0));
  EXPECT_NEAR(ValueOf(document, "gamma"), 0.01, 1.5e-4);
}

TEST_F(Diagnosis, IsExactForLargeFaults) {
  const std::string filters = Filters();
  const std::string out = Path("run");
  ASSERT_EQ(RunCommand(std::string("simulate ") + kLinear +
                       "--fault zeta_x=1.2 --fault eta_y=0.98 --report --out " + out)
                .status,
            0);
  const json document = JsonOf("diagnose --setup mjcf/ab383 --filters " + filters +
                               " --record " + out + "/record.csv");
  // Five standard deviations, as the information bound has them.
  EXPECT_NEAR(ValueOf(document, "zeta_x"), 1.2, 5e-6);
  EXPECT_NEAR(ValueOf(document, "eta_y"), 0.98, 5e-7);
}

// Dry friction is an unknown beside the faults: no baseline, and nothing leaks.
TEST_F(Diagnosis, NamesLargeFaultsAloneAndAtTheirValuesOnTheNonlinearPlant) {
  const std::string out = Path("run");
  const CommandResult result = RunCommand(
      "simulate --setup mjcf/ab383 --fault zeta_x=1.2 --fault eta_y=0.98 "
      "--duration 0.5 --diagnose --report --out " +
      out);
  ASSERT_EQ(result.status, 0) << result.err;
  const json document = json::parse(ReadAll(out + "/diagnosis.json"));
  std::vector<std::string> detected;
  for (const json& fault : document["faults"]) {
    if (fault["detected"]) detected.push_back(fault["name"]);
  }
  EXPECT_THAT(detected, ::testing::UnorderedElementsAre("zeta_x", "eta_y"));
  // Five standard deviations.
  EXPECT_NEAR(ValueOf(document, "zeta_x"), 1.2, 1e-5);
  EXPECT_NEAR(ValueOf(document, "eta_y"), 0.98, 1e-6);
  EXPECT_THAT(result.out, HasSubstr("Detected: eta_y = 0.98, zeta_x = 1.2."));
  EXPECT_THAT(ReadAll(out + "/report.html"),
              HasSubstr("Detected: eta_y = 0.98, zeta_x = 1.2."));
}

TEST_F(Diagnosis, WritesThePageOfADesignBesideItsFilters) {
  const std::string page =
      ReadAll(fs::path(Filters()).parent_path() / "design.page.json");
  EXPECT_THAT(page,
              AllOf(HasSubstr("Residual of healthy runs"),
                    HasSubstr("half power at 50.0 Hz"), HasSubstr("beta_x = 0.01")));
  EXPECT_FALSE(json::parse(ReadAll(Filters())).contains("linear_program"));
}

TEST_F(Diagnosis, FindsByLinearProgramsARelationOfTheSameNullSpace) {
  const std::string out = Path("lp");
  const CommandResult result =
      RunCommand(std::string("design ") + kLinear + "--method lp --out " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("Linear programs: "));
  json document = json::parse(ReadAll(out + "/filters.json"));
  const json programs = document["linear_program"];
  EXPECT_EQ(programs["degree"], 7);
  EXPECT_EQ(programs["norm"], "one");
  // m = n_f (d_F + d_N + 1) with d_F = 0.
  EXPECT_EQ(programs["programs"], 8 * programs["fault_inputs"].get<int>());
  EXPECT_GT(programs["feasible"], 0);
  EXPECT_LT(programs["feasible"], programs["programs"]);
  EXPECT_LT(programs["defect"], 1e-15);
  EXPECT_LT(programs["angle"], 1e-9);
  // The filters stay those of the singular value decomposition.
  json other = json::parse(ReadAll(Filters()));
  for (json* file : {&document, &other}) {
    file->erase("linear_program");
    file->erase("command");
  }
  EXPECT_EQ(document, other);
  EXPECT_THAT(ReadAll(out + "/design.page.json"), HasSubstr("Linear programs: "));
}

TEST_F(Diagnosis, RefusesAMethodThatItDoesNotKnow) {
  EXPECT_THAT(Refused("design --setup mjcf/ab383 --method simplex"),
              HasSubstr("simplex"));
}

TEST_F(Diagnosis, RefusesADegreeWithoutParityRelations) {
  EXPECT_THAT(
      Refused("design --setup mjcf/ab383 --set diagnosis.degree=5"),
      AllOf(HasSubstr("no parity relation of degree 5"), HasSubstr("at least 6")));
}

TEST_F(Diagnosis, RefusesADenominatorBelowTheNumerator) {
  EXPECT_THAT(Refused("design --setup mjcf/ab383 --set diagnosis.order=6"),
              AllOf(HasSubstr("order 6"), HasSubstr("at least the degree")));
}

TEST_F(Diagnosis, RefusesAPlantWhoseSensorsSeeTooLittle) {
  // With all three motor forces unknown no parity relation is left.
  EXPECT_THAT(Refused("design --setup mjcf/ab383 --set "
                      "'diagnosis.unknown_forces=[\"X\",\"Y\",\"Z\"]'"),
              HasSubstr("fewer unknown inputs"));
}

TEST_F(Diagnosis, RefusesAHorizonLongerThanTheRecord) {
  const std::string filters = Filters();
  const std::string out = Path("run");
  RunCommand(std::string("simulate ") + kLinear + "--duration 0.2 --out " + out);
  const std::string setup = "--set diagnosis.estimation.horizon=0.5 ";
  const std::string made = Path("longer");
  ASSERT_EQ(
      RunCommand(std::string("design ") + kLinear + setup + "--out " + made).status, 0);
  EXPECT_THAT(Refused("diagnose --setup mjcf/ab383 --filters " + made +
                      "/filters.json --record " + out + "/record.csv"),
              AllOf(HasSubstr("horizon"), HasSubstr("500 ms"), HasSubstr("200 ms")));
}

TEST_F(Diagnosis, NamesTheFaultsThatCannotBeToldApart) {
  const std::string setup =
      Changed("plant.xml", R"(<text name="fault.zeta_x" data="damping X"/>)",
              R"(<text name="fault.zeta_x" data="damping X"/>)"
              R"(<text name="fault.worn" data="damping X"/>)");
  EXPECT_THAT(
      Refused("simulate --linear --duration 0.3 --diagnose --setup '" + setup + "'"),
      AllOf(HasSubstr("tell these faults apart"), HasSubstr("zeta_x, worn")));
}

TEST_F(Diagnosis, RefusesARecordWhoseTimesAreInAnotherUnit) {
  const std::string record =
      folder_.Write("slow.csv",
                    "time [s],x [m],y [m],z [rad],u_x [N],u_y [N],u_z [N m]\n"
                    "0,0,0,0,0,0,0\n0.01,0,0,0,0,0,0\n0.02,0,0,0,0,0,0\n");
  EXPECT_THAT(Refused("diagnose --setup mjcf/ab383 --filters " + Filters() +
                      " --record " + record),
              AllOf(HasSubstr("10.0 ms"), HasSubstr("125 µs")));
}

TEST_F(Diagnosis, RefusesFiltersOfAnotherMachine) {
  EXPECT_THAT(Refused("simulate --setup mjcf/emps --diagnose --filters " + Filters()),
              AllOf(HasSubstr("filters.json"), HasSubstr("EMPS")));
}

TEST_F(Diagnosis, RefusesHalfAFileOfFilters) {
  const std::string whole = ReadAll(Filters());
  for (const double part : {0.0, 0.3, 0.999}) {
    const std::string file = folder_.Write(
        "half.json",
        whole.substr(
            0, static_cast<std::size_t>(part * static_cast<double>(whole.size() - 3))));
    EXPECT_THAT(Refused("simulate --setup mjcf/ab383 --diagnose --filters " + file),
                HasSubstr("half.json"));
  }
}

TEST(Tolerate, SaysWhatWasCorrectedAndSinceWhen) {
  const std::string run =
      "simulate --setup mjcf/ab383 --linear --fault eta_x=0.7 --duration 0.3 "
      "--tolerate";
  const CommandResult text = RunCommand(run);
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_NE(text.out.find("drive gain of x"), std::string::npos) << text.out;
  const auto document = nlohmann::json::parse(RunCommand(run + " --json").out);
  const auto& faults = document["tolerance"]["faults"];
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0]["name"], "eta_x");
  EXPECT_NEAR(faults[0]["value"].get<double>(), 0.7, 1e-3);
  EXPECT_LT(faults[0]["since"].get<double>(), 0.2);
  EXPECT_TRUE(faults[0]["until"].is_null());
}

TEST(Tolerate, NeedsATwin) {
  const CommandResult quiet = RunCommand("simulate --setup mjcf/emps --tolerate");
  EXPECT_EQ(quiet.status, 2);
  EXPECT_NE(quiet.err.find("the diagnosis has no twin"), std::string::npos);
}

TEST(Study, PrintsTheBoundAndWhatEstimatorsMakeOfIt) {
  const json document = JsonOf("study --setup mjcf/ab383 --preset bound");
  EXPECT_EQ(document["schema"], "mjdiag.study/1");
  const json& rows = document["tables"][0]["rows"];
  ASSERT_EQ(rows.size(), 8u);
  for (const json& row : rows) {
    EXPECT_LE(row[1].get<double>(), row[2].get<double>()) << row;
    EXPECT_GT(row[4].get<double>(), 1.0) << row;  // no estimator beats the bound
    EXPECT_LE(row[6].get<double>(), row[4].get<double>() * 1.01) << row;
  }
}

TEST(Study, WritesAPageWithItsTables) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "bound").string();
  const CommandResult result =
      RunCommand("study --setup mjcf/ab383 --preset bound --report --out " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("report.html"));
  EXPECT_THAT(ReadAll(out + "/report.html"),
              AllOf(HasSubstr("Study bound of AB383"), HasSubstr("<td>zeta_x</td>"),
                    HasSubstr("Standard deviations of the deviation")));
}

TEST(Study, KeepsFinishedRowsWhenItIsKilled) {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "random").string();
  const pid_t study = fork();
  ASSERT_NE(study, -1);
  if (study == 0) {
    const bool ready =
        chdir(MJDIAG_SOURCE_DIR) == 0 && freopen("/dev/null", "w", stdout) != nullptr;
    if (ready) {
      execl(MJDIAG_COMMAND, MJDIAG_COMMAND, "study", "--setup", "mjcf/ab383", "--set",
            "trajectories.multi.duration=0.5", "--preset", "random-faults", "--linear",
            "--runs", "100000", "--out", out.c_str(), static_cast<char*>(nullptr));
    }
    _exit(127);
  }
  const fs::path file = fs::path(out) / "study.json";
  constexpr int kPatience = 1200;
  for (int i = 0; i < kPatience && !fs::exists(file); ++i) usleep(50000);
  kill(study, SIGKILL);
  int status = 0;
  waitpid(study, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  const json document = json::parse(ReadAll(file));
  EXPECT_EQ(document["finished"], false);
  EXPECT_EQ(document["linear"], true);
  EXPECT_GE(document["tables"][0]["rows"].size(), 1u);
}

TEST(Study, ShowsRowsAsTheyComeAndEveryTableOnce) {
  const CommandResult result = RunCommand(
      "study --setup mjcf/ab383 --set trajectories.multi.duration=0.25 "
      "--preset random-faults --linear --runs 2 --seed 3");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("Random faults of AB383"),
                    HasSubstr("standard deviations of its information bound"),
                    HasSubstr("\n3 "), HasSubstr("\n4 "),
                    HasSubstr("How often the names are right")));
  const std::string title = "Random faults of";
  EXPECT_EQ(result.out.find(title), result.out.rfind(title));
}

TEST(Study, RefusesAnotherPlantWhereItHasItsOwn) {
  EXPECT_THAT(Refused("study --setup mjcf/ab383 --preset bound --linear"),
              HasSubstr("--linear: bound has its own plant"));
}

TEST(Study, ListsThePresetsWhenOneIsUnknown) {
  EXPECT_THAT(Refused("study --setup mjcf/ab383 --preset table9"),
              AllOf(HasSubstr("table9"), HasSubstr("table2")));
}

}  // namespace
}  // namespace mjdiag
