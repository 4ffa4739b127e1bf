#include "mjdiag/studies/plan/study_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/plan/planned_run.h"
#include "mjdiag/studies/plan/run_machine.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kHead = R"(schema = "mjdiag.plan/1"
name = "test"
setup = "mjcf/ab383"
linear = true
trajectories = ["xy"]
)";
constexpr const char* kKeep = R"(
[keep]
records = ["x"]
)";

LoadedPlan Parsed(const std::string& body, const std::string& keep = kKeep) {
  return ParsePlan(kHead + body + keep, MJDIAG_SOURCE_DIR);
}

std::string Complaint(const std::string& body, const std::string& keep = kKeep) {
  return test::MessageOf<InputError>([&] { Parsed(body, keep); });
}

TEST(StudyPlan, SaysLineKeyAndWhatWasExpected) {
  EXPECT_THAT(Complaint("metod = \"random\"\n"),
              AllOf(HasSubstr("plan:6: metod: unknown key"), HasSubstr("method")));
  EXPECT_THAT(Complaint("method = \"rndom\"\n"),
              AllOf(HasSubstr("plan:6: method"), HasSubstr("\"sobol\"")));
  EXPECT_THAT(Complaint("[[axis]]\nfault = \"zeta_q\"\nvalues = [1]\n"),
              AllOf(HasSubstr("plan:7: axis[0].fault"), HasSubstr("zeta_q"),
                    HasSubstr("zeta_x")));
  EXPECT_THAT(Complaint("[[axis]]\nfault = \"zeta_x\"\nvalues = [-1]\n"),
              AllOf(HasSubstr("plan:8: axis[0].values"), HasSubstr("out of range")));
  EXPECT_THAT(Complaint("[[axis]]\nfault = \"zeta_x\"\n"), HasSubstr("has no values"));
  EXPECT_THAT(Complaint("[[axis]]\nvalues = [1]\n"),
              AllOf(HasSubstr("plan:6: axis[0]"), HasSubstr("fault, effect, key")));
  EXPECT_THAT(
      Complaint("[[axis]]\nfault = \"zeta_x\"\nfrom = 0.9\nto = 1.1\n"
                "scale = \"log\"\n"),
      AllOf(HasSubstr("plan:10: axis[0].scale"), HasSubstr("healthy value, 1")));
  EXPECT_THAT(Complaint("[[axis]]\neffect = \"coulomb_friction@X\"\n"
                        "parameter = \"force\"\nvalues = [1]\n"),
              AllOf(HasSubstr("plan:7"), HasSubstr("linear plant")));
  EXPECT_THAT(Complaint("[[axis]]\nkey = \"sensors.q.noise_sd\"\nvalues = [1]\n"),
              AllOf(HasSubstr("plan:8: axis[0].values"), HasSubstr("sensors.q")));
  EXPECT_THAT(Complaint("[[axis]]\nfault = \"gamma\"\nvalues = [1]\nappears = 0.1\n"
                        "grows = 0.1\n"),
              AllOf(HasSubstr("plan:10"), HasSubstr("at once")));
  EXPECT_THAT(Complaint("[[axis]]\nfault = \"zeta_x\"\nvalues = [2]\nappears = 9\n"),
              AllOf(HasSubstr("zeta_x"), HasSubstr("after the end")));
  EXPECT_THAT(Complaint("method = \"random\"\n"),
              HasSubstr("plan:1: points: is missing"));
  EXPECT_THAT(Complaint("", "[keep]\nrecords = [\"q\"]\n"),
              AllOf(HasSubstr("plan:7: keep.records"), HasSubstr("u_x")));
  EXPECT_THAT(Complaint("", "[keep]\n"), HasSubstr("nothing is kept"));
  EXPECT_THAT(Complaint("[machines]\ncount = 2\nsplit = { train = 0.5 }\n"),
              AllOf(HasSubstr("machines.split"), HasSubstr("add up to 1")));
  EXPECT_THAT(Complaint("[machines]\ncount = 2\nsplit = { train = 0.9, test = 0.1 }\n"),
              HasSubstr("leaves no machine for test"));
  EXPECT_THAT(
      Complaint("[machines]\nnumbers = [\"mass\"]\n"),
      AllOf(HasSubstr("machines.numbers"), HasSubstr("exact"), HasSubstr("usual")));
  EXPECT_THAT(Complaint("[[case]]\nname = \"a\"\nchoose = [1, 2]\n"),
              AllOf(HasSubstr("plan:8"), HasSubstr("0 axes")));
  EXPECT_THAT(Complaint("seed = \n"), HasSubstr("plan:6"));
}

constexpr const char* kMachines = R"(method = "random"
points = 3
replications = 2
trajectories = ["x", "xy"]
[machines]
count = 8
numbers = ["mass", "stiffness@u1"]
spread = "usual"
split = { train = 0.5, validation = 0.25, test = 0.25 }
[[axis]]
fault = "zeta_x"
from = 1.1
to = 2
)";

LoadedPlan Machines() {
  std::string head = kHead;
  head = head.substr(0, head.find("trajectories"));
  return ParsePlan(head + kMachines + kKeep, MJDIAG_SOURCE_DIR);
}

TEST(StudyPlan, ARunIsAFunctionOfPlanAndNumberAlone) {
  const LoadedPlan plan = Machines();
  const RunPlanner forwards(plan.plan);
  const RunPlanner again(plan.plan);
  ASSERT_EQ(forwards.runs(), 8 * 3 * 2 * 2);
  std::map<std::int64_t, PlannedRun> runs;
  for (std::int64_t i = 0; i < forwards.runs(); ++i) runs[i] = forwards.Run(i);
  std::set<std::uint64_t> seeds;
  for (std::int64_t i = forwards.runs() - 1; i >= 0; --i) {
    const PlannedRun run = again.Run(i);
    EXPECT_EQ(run.axes[0].value, runs[i].axes[0].value);
    EXPECT_EQ(run.seed, runs[i].seed);
    EXPECT_EQ(run.numbers, runs[i].numbers);
    seeds.insert(run.seed);
  }
  EXPECT_EQ(seeds.size(), runs.size());
}

TEST(StudyPlan, SplitsAreOfMachinesAndPointsOfTheirRuns) {
  const LoadedPlan plan = Machines();
  const RunPlanner planner(plan.plan);
  std::map<int, std::set<Split>> splits;
  std::map<int, std::set<double>> masses;
  std::map<std::int64_t, std::set<double>> values;
  for (std::int64_t i = 0; i < planner.runs(); ++i) {
    const PlannedRun run = planner.Run(i);
    splits[run.machine].insert(run.split);
    masses[run.machine].insert(run.numbers.front().second);
    values[run.point].insert(run.axes[0].value);
  }
  std::map<Split, int> counts;
  std::set<double> all_masses;
  for (const auto& [machine, of_one] : splits) {
    EXPECT_EQ(of_one.size(), 1u);
    ++counts[*of_one.begin()];
    EXPECT_EQ(masses[machine].size(), 1u);
    all_masses.insert(*masses[machine].begin());
  }
  EXPECT_EQ(counts,
            (std::map<Split, int>{
                {Split::kTrain, 4}, {Split::kValidation, 2}, {Split::kTest, 2}}));
  EXPECT_EQ(all_masses.size(), 8u);
  EXPECT_EQ(values.size(), 24u);
  std::set<double> all_values;
  for (const auto& [point, of_one] : values) {
    EXPECT_EQ(of_one.size(), 1u);
    all_values.insert(*of_one.begin());
  }
  EXPECT_EQ(all_values.size(), 24u);
}

TEST(StudyPlan, AGridHasEveryCombinationOnce) {
  const LoadedPlan plan = Parsed(R"([[axis]]
fault = "zeta_x"
values = [1, 2, 3]
[[axis]]
fault = "eta_x"
from = 0.9
to = 0.99999
scale = "log"
points = 4
)");
  const RunPlanner planner(plan.plan);
  ASSERT_EQ(planner.runs(), 12);
  std::set<std::pair<double, double>> seen;
  std::set<double> etas;
  for (std::int64_t i = 0; i < 12; ++i) {
    const PlannedRun run = planner.Run(i);
    seen.emplace(run.axes[0].value, run.axes[1].value);
    etas.insert(run.axes[1].value);
  }
  EXPECT_EQ(seen.size(), 12u);
  ASSERT_EQ(etas.size(), 4u);
  EXPECT_EQ(*etas.begin(), 0.9);
  EXPECT_EQ(*etas.rbegin(), 0.99999);
  // Evenly in the logarithm of what is missing to 1.
  const double ratio = (1.0 - *std::next(etas.begin())) / (1.0 - *etas.begin());
  EXPECT_NEAR(ratio, std::pow(1e-5 / 0.1, 1.0 / 3.0), 1e-9);
}

TEST(StudyPlan, ASobolSequenceFillsItsAxesEvenly) {
  const LoadedPlan plan = Parsed(R"(method = "sobol"
points = 64
[[axis]]
fault = "zeta_x"
from = 1
to = 2
[[axis]]
fault = "zeta_y"
from = 1
to = 2
)");
  const RunPlanner planner(plan.plan);
  std::array<std::vector<double>, 2> axes;
  std::array<std::array<int, 4>, 4> squares{};
  for (std::int64_t i = 0; i < 64; ++i) {
    const PlannedRun run = planner.Run(i);
    std::array<std::size_t, 2> part{};
    for (std::size_t k = 0; k < 2; ++k) {
      axes[k].push_back(run.axes[k].value - 1.0);
      part[k] = static_cast<std::size_t>(4.0 * axes[k].back());
    }
    ++squares[part[0]][part[1]];
  }
  // The first 2^k points have one in every part of 2^-k, wherever the parts begin.
  for (auto& axis : axes) {
    std::ranges::sort(axis);
    for (std::size_t i = 1; i < axis.size(); ++i) {
      EXPECT_NEAR(axis[i] - axis[i - 1], 1.0 / 64.0, 1e-12);
    }
  }
  // Nor is a square left out: of independent draws one of 16 is empty one time in four.
  for (const auto& row : squares) {
    for (const int count : row) EXPECT_NEAR(count, 4, 3);
  }
}

TEST(StudyPlan, ChoosesSoManyFaultsAndLeavesOthersHealthy) {
  const LoadedPlan plan = Parsed(R"(method = "random"
points = 100
[[axis]]
noise = "all"
values = [2]
[[case]]
name = "some"
choose = [1, 2]
[[case.axis]]
fault = "zeta_x"
ranges = [{ from = 0.99, to = 0.5 }, { from = 1.01, to = 2 }]
scale = "log"
[[case.axis]]
fault = "eta_x"
values = [0.9]
[[case.axis]]
fault = "gamma"
values = [0.1]
)");
  const RunPlanner planner(plan.plan);
  std::map<std::string, int> labels;
  int below = 0;
  for (std::int64_t i = 0; i < 100; ++i) {
    const PlannedRun run = planner.Run(i);
    int present = 0;
    for (const DrawnAxis& axis : run.axes) present += axis.present() ? 1 : 0;
    EXPECT_GE(present, 1);
    EXPECT_LE(present, 2);
    EXPECT_EQ(run.axes[0].value, 2.0);  // of all cases
    ++labels[run.Label()];
    const double zeta = run.axes[1].value;
    EXPECT_TRUE(zeta == 1.0 || (zeta >= 0.5 && zeta <= 0.99) ||
                (zeta >= 1.01 && zeta <= 2.0))
        << zeta;
    below += zeta < 1.0 ? 1 : 0;
  }
  EXPECT_EQ(labels.size(), 6u);  // three alone, three pairs
  EXPECT_GT(below, 5);
}

TEST(StudyPlan, AFaultAppearsAndGrowsWhenThePlanSaysSo) {
  const LoadedPlan plan = Parsed(R"([[axis]]
fault = "eta_x"
values = [1, 0.8]
appears = 0.1
grows = 0.05
)");
  const RunPlanner planner(plan.plan);
  const RunMaker maker(plan);
  const Record healthy = maker.Simulate(planner.Run(0));
  PlannedRun faulty = planner.Run(1);
  faulty.seed = planner.Run(0).seed;
  const Record worn = maker.Simulate(faulty);
  const Eigen::VectorXd off = worn.At("x").samples - healthy.At("x").samples;
  EXPECT_EQ(off.head(800).cwiseAbs().maxCoeff(), 0.0);
  const double early = off.segment(800, 200).norm();
  const double late = off.segment(1600, 200).norm();  // the same part of the motion
  EXPECT_GT(early, 0.0);
  EXPECT_GT(late, 3.0 * early);
}

TEST(StudyPlan, ReplaysRecordsWhereThereAreNoControllers) {
  const test::TemporaryFolder folder;
  std::string rows = "time [s],i [A]\n";
  for (int k = 0; k < 100; ++k) {
    rows += std::to_string(k / 5000.0) + "," + std::to_string(0.001 * k) + "\n";
  }
  folder.Write("current.csv", rows);
  const auto text = [](const std::string& motion) {
    return "schema = \"mjdiag.plan/1\"\nname = \"coil\"\nsetup = \"" MJDIAG_SOURCE_DIR
           "/mjcf/voice_coil\"\n" +
           motion + "[keep]\nrecords = [\"all\"]\n";
  };
  const LoadedPlan plan =
      ParsePlan(text("replay = [\"current.csv\"]\n"), folder.path());
  const Record record = RunMaker(plan).Simulate(RunPlanner(plan.plan).Run(0));
  EXPECT_EQ(record.samples(), 100);
  EXPECT_NEAR(record.At("i").samples[50], 0.05, 1e-12);
  const auto refused = [&](const std::string& motion) {
    return test::MessageOf<InputError>([&] { ParsePlan(text(motion), folder.path()); });
  };
  EXPECT_THAT(refused(""), HasSubstr("nothing moves the machine"));
  EXPECT_THAT(refused("trajectories = [\"xy\"]\n"), HasSubstr("no controlled axes"));
  EXPECT_THAT(refused("replay = [\"none.csv\"]\n"), HasSubstr("none.csv"));
}

TEST(StudyPlan, PutsEffectsKeysAndNoiseIntoTheRun) {
  std::string head = kHead;
  head.replace(head.find("true"), 4, "false");
  const LoadedPlan plan = ParsePlan(head + R"(duration = 0.01
[[axis]]
effect = "stribeck_friction@X:velocity=0.02,breakaway=2"
parameter = "coulomb"
values = [0, 1.5]
[[axis]]
key = "sensors.y.noise_power"
values = [5e-20, 5e-18]
[[axis]]
noise = "all"
values = [3]
)" + kKeep,
                                    MJDIAG_SOURCE_DIR);
  const RunPlanner planner(plan.plan);
  const RunMaker maker(plan);
  const ReadyRun none = maker.Make(planner.Run(0));
  EXPECT_TRUE(none.machine.changes().effects.empty());
  EXPECT_EQ(planner.Run(0).Label(), "healthy");
  const PlannedRun run = planner.Run(3);
  EXPECT_EQ(run.Label(), "stribeck_friction@X");
  const ReadyRun ready = maker.Make(run);
  ASSERT_EQ(ready.machine.changes().effects.size(), 1u);
  EXPECT_EQ(ready.machine.changes().effects[0].Value("coulomb"), 1.5);
  EXPECT_EQ(ready.machine.changes().effects[0].Value("velocity"), 0.02);
  EXPECT_EQ(ready.options.noise_scale, 3.0);
  EXPECT_NEAR(ready.machine.channels().Sensor("y").noise_sd, 2e-7, 1e-12);
  EXPECT_NEAR(none.machine.channels().Sensor("y").noise_sd, 2e-8, 1e-13);
}

}  // namespace
}  // namespace mjdiag
