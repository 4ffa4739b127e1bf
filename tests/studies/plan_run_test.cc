#include "mjdiag/studies/dataset/plan_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/dataset/dataset_file.h"
#include "mjdiag/studies/dataset/plan_tables.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

constexpr const char* kPlan = R"(schema = "mjdiag.plan/1"
name = "test"
setup = "mjcf/ab383"
linear = true
trajectories = ["xy", "x"]
duration = 0.06
method = "sobol"
points = 5

[machines]
count = 2
numbers = ["mass"]
spread = "usual"
split = { train = 0.5, test = 0.5 }

[keep]
records = ["x", "u_x"]
joints = ["X"]
every = 4
precision = "single"
features = ["x", "u_x"]
segment = 256

[[axis]]
fault = "eta_x"
from = 0.99
to = 0.9
scale = "log"
)";

LoadedPlan Plan(const std::string& text = kPlan) {
  return ParsePlan(text, MJDIAG_SOURCE_DIR);
}

std::string Bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct Stop {};

/// Runs the plan until so many runs have been made.
void RunSome(const LoadedPlan& plan, const std::filesystem::path& folder,
             std::int64_t runs) {
  PlanRunOptions options{folder};
  options.progress = [runs](const PlanProgress& progress) {
    if (progress.done - progress.found >= runs) throw Stop{};
  };
  EXPECT_THROW(RunPlan(plan, options), Stop);
}

TEST(PlanRun, GoesOnWhereItEndedAndGivesTheSameBits) {
  const test::TemporaryFolder folder;
  const LoadedPlan plan = Plan();
  const PlanOutcome whole = RunPlan(plan, {folder / "whole"});
  EXPECT_EQ(whole.progress.done, 20);
  RunSome(plan, folder / "parts", 3);
  RunSome(plan, folder / "parts", 6);
  std::atomic<int> made = 0;
  PlanRunOptions options{folder / "parts"};
  std::int64_t found = 0;
  options.progress = [&](const PlanProgress& progress) {
    found = progress.found;
    ++made;
  };
  const PlanOutcome parts = RunPlan(plan, options);
  EXPECT_GE(found, 9);
  EXPECT_LE(found, 13);  // those that other threads had begun
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(whole.results[i].features, parts.results[i].features) << i;
  }
  if (!WritesDatasets()) GTEST_SKIP() << "built without HDF5";
  EXPECT_EQ(Bytes(folder / "whole/dataset.h5"), Bytes(folder / "parts/dataset.h5"));
  EXPECT_GT(Bytes(folder / "whole/dataset.h5").size(), 10000u);
}

TEST(PlanRun, MakesNoRunTwice) {
  const test::TemporaryFolder folder;
  const LoadedPlan plan = Plan();
  const PlanOutcome first = RunPlan(plan, {folder / "study"});
  const auto written = std::filesystem::last_write_time(folder / "study/runs.journal");
  const PlanOutcome again = RunPlan(plan, {folder / "study"});
  EXPECT_EQ(again.progress.found, 20);
  EXPECT_EQ(std::filesystem::last_write_time(folder / "study/runs.journal"), written);
  EXPECT_EQ(first.results[7].features, again.results[7].features);
  PlanRunOptions afresh{folder / "study"};
  afresh.restart = true;
  EXPECT_EQ(RunPlan(plan, afresh).progress.found, 0);
  if (!WritesDatasets()) return;
  // Records that nobody has any more are made again.
  const std::string bytes = Bytes(folder / "study/dataset.h5");
  std::filesystem::remove(folder / "study/dataset.h5");
  RunPlan(plan, {folder / "study"});
  EXPECT_EQ(Bytes(folder / "study/dataset.h5"), bytes);
}

TEST(PlanRun, RefusesAFolderWithAnotherPlan) {
  const test::TemporaryFolder folder;
  RunPlan(Plan(), {folder / "study"});
  const std::string bytes = Bytes(folder / "study/plan.toml");
  const LoadedPlan other = Plan(std::string(kPlan) + "# another\n");
  EXPECT_THAT(test::MessageOf<InputError>([&] { RunPlan(other, {folder / "study"}); }),
              HasSubstr("another plan"));
  EXPECT_EQ(Bytes(folder / "study/plan.toml"), bytes);
}

TEST(PlanRun, ARunThatDivergesIsAResult) {
  const test::TemporaryFolder folder;
  const LoadedPlan plan = Plan(R"(schema = "mjdiag.plan/1"
name = "test"
setup = "mjcf/ab383"
linear = true
trajectories = ["x"]
[keep]
records = ["x"]
[[axis]]
fault = "eta_x"
values = [1, 1000]
)");
  const PlanOutcome outcome = RunPlan(plan, {folder / "study"});
  EXPECT_FALSE(outcome.results[0].diverged());
  EXPECT_TRUE(outcome.results[1].diverged());
  EXPECT_THAT(outcome.results[1].failure, HasSubstr("diverged"));
  EXPECT_EQ(PlanTables(outcome).front().rows[0][2].number, 1.0);
}

/// All zeta_x of the largest size are found, none of the smallest.
TEST(PlanRun, SaysHowOftenWhatIsFound) {
  const test::TemporaryFolder folder;
  const LoadedPlan plan = Plan(R"(schema = "mjdiag.plan/1"
name = "test"
setup = "mjcf/ab383"
linear = true
trajectories = ["xy"]
replications = 5
[keep]
verdicts = true
estimates = true
residual = true
every = 8
[[case]]
name = "healthy"
[[case]]
name = "worn"
[[case.axis]]
fault = "zeta_x"
values = [1.00000001, 1.001]
)");
  const PlanOutcome outcome = RunPlan(plan, {folder / "study"});
  const std::vector<StudyTable> tables = PlanTables(outcome);
  const auto find = [&](const std::string& title) -> const StudyTable& {
    for (const StudyTable& table : tables) {
      if (table.title.find(title) != std::string::npos) return table;
    }
    throw std::runtime_error("no table " + title);
  };
  EXPECT_EQ(tables.front().rows.size(), 2u);
  const StudyTable& detection = find("zeta_x is named");
  ASSERT_EQ(detection.rows.size(), 2u);
  EXPECT_EQ(detection.rows[0][3].number, 0.0);
  EXPECT_EQ(detection.rows[1][3].number, 100.0);
  ASSERT_TRUE(detection.plot.has_value());
  EXPECT_NEAR(detection.plot->points[1].x, -3.0, 1e-9);
  EXPECT_EQ(detection.plot->points[1].high, 1.0);
  const StudyTable& confusion = find("taken for what");
  ASSERT_EQ(confusion.rows.size(), 2u);
  EXPECT_EQ(confusion.rows[0][0].text, "healthy");
  EXPECT_EQ(confusion.rows[0][1].number, 5.0);  // nothing named
  EXPECT_EQ(confusion.rows[1][2].number, 5.0);  // zeta_x
  const StudyTable& errors = find("Errors of the estimates");
  EXPECT_EQ(errors.rows[0][0].text, "zeta_x");
  EXPECT_LT(std::abs(errors.rows[0][2].number), 1e-5);
  EXPECT_GT(errors.rows[0][4].number, 0.0);
}

}  // namespace
}  // namespace mjdiag
