#include "mjdiag/studies/random_fault_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/preset/preset_plan.h"
#include "support/bonder.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::EndsWith;

LoadedPlan DrawnPlan(const std::vector<std::string>& overrides = {}) {
  return ReadPreset("random-faults", test::Bonder(overrides));
}

const PlanAxis& DrawnAxisOf(const LoadedPlan& plan, const std::string& name) {
  return *std::ranges::find(plan.plan.cases.front().axes, name, &PlanAxis::name);
}

TEST(DrawnSizes, AreThoseOfTheSetup) {
  const LoadedPlan plan = DrawnPlan();
  ASSERT_EQ(plan.plan.cases.front().axes.size(), 8u);
  const PlanAxis& zeta = DrawnAxisOf(plan, "zeta_x");
  ASSERT_EQ(zeta.ranges.size(), 2u);
  EXPECT_DOUBLE_EQ(zeta.ranges[0].from, 0.99999);
  EXPECT_DOUBLE_EQ(zeta.ranges[0].to, 0.5);
  EXPECT_DOUBLE_EQ(zeta.ranges[1].from, 1.00001);
  EXPECT_DOUBLE_EQ(zeta.ranges[1].to, 2.0);
  ASSERT_EQ(DrawnAxisOf(plan, "beta_y").ranges.size(), 1u);
  EXPECT_EQ(DrawnAxisOf(plan, "beta_y").ranges[0].to, 0.3);
  EXPECT_EQ(DrawnAxisOf(plan, "gamma").healthy, 0.0);
}

TEST(DrawnSizes, RefuseOneThatLeavesNothing) {
  const std::string message = test::MessageOf<InputError>(
      [] { DrawnPlan({"studies.random_least.beta_x=0.2"}); });
  EXPECT_THAT(
      message,
      EndsWith("studies.random_least.beta_x: leaves nothing to be drawn; expected a "
               "value between healthy and random_low or random_high"));
}

// Of 2000 draws: shares within 4 binomial standard deviations, of at most
// sqrt(0.25 / 2000) = 0.011 each.
TEST(DrawFaults, IsEvenOverNumbersSidesSizesAndStarts) {
  constexpr int kDraws = 2000;
  constexpr double kBand = 4.0 * 0.0112;
  const LoadedPlan plan = DrawnPlan();
  const std::vector<PlanAxis>& axes = plan.plan.cases.front().axes;
  std::array<double, 4> counts{};
  double from_rest = 0.0;
  double faults = 0.0;
  double small = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const RandomDraw draw = DrawFaults({}, axes, 20000, static_cast<std::uint64_t>(i));
    counts.at(draw.faults.size()) += 1.0 / kDraws;
    from_rest += draw.from == 0 ? 1.0 / kDraws : 0.0;
    EXPECT_LT(draw.from, 10000);
    std::set<std::string> names;
    for (const DrawnAxis& fault : draw.faults) {
      names.insert(fault.axis->name);
      const double away = fault.value - fault.axis->healthy;
      const auto side =
          std::ranges::find_if(fault.axis->ranges, [&](const ValueRange& range) {
            return (range.to > range.from) == (away > 0);
          });
      ASSERT_NE(side, fault.axis->ranges.end());
      const double least = std::abs(side->from - fault.axis->healthy);
      const double most = std::abs(side->to - fault.axis->healthy);
      EXPECT_GE(std::abs(away), least * (1.0 - 1e-9));
      EXPECT_LE(std::abs(away), most);
      ++faults;
      small += std::abs(away) < std::sqrt(least * most) ? 1.0 : 0.0;
    }
    EXPECT_EQ(names.size(), draw.faults.size());
  }
  EXPECT_NEAR(counts[0], 0.2, kBand);
  for (int n = 1; n <= 3; ++n) EXPECT_NEAR(counts.at(n), 0.8 / 3.0, kBand) << n;
  EXPECT_NEAR(from_rest, 0.25, kBand);
  EXPECT_NEAR(small / faults, 0.5, kBand);
}

TEST(RandomOutcome, IsRightWithoutFaintFaultsOrWithThem) {
  RandomOutcome run;
  run.truth = Eigen::Vector3d(1.0, 0.05, 0.0);
  run.bound = Eigen::Vector3d::Constant(0.01);  // the second is at 5 of them
  run.reading.named = {true, false, false};
  EXPECT_TRUE(run.Right());
  run.reading.named = {true, true, false};
  EXPECT_TRUE(run.Right());
  run.reading.named = {true, true, true};
  EXPECT_TRUE(run.False(2));
  EXPECT_FALSE(run.Right());
  run.reading.named = {false, true, false};
  EXPECT_TRUE(run.Missed(0));
  EXPECT_FALSE(run.Right());
}

// Six draws on the linear plant, half of the motion. The errors of an estimator at the
// bound: of 6 x 7, all within 4.9 standard deviations with a probability of 0.99996.
TEST(RandomFaultStudy, NamesWhatWasDrawnOnTheLinearPlant) {
  LoadedPlan plan = DrawnPlan({"trajectories.multi.duration=1"});
  plan.plan.SetRuns(6);
  plan.plan.linear = true;
  StudyOptions options;
  std::size_t shown = 0;
  options.row = [&](const StudyTable& table) { shown = table.rows.size(); };
  const std::vector<StudyTable> tables = AnswerTo(plan, options);
  EXPECT_EQ(shown, 6u);
  for (const auto& row : tables[0].rows) {
    EXPECT_EQ(row[2].text, "right") << row[9].text << " named " << row[6].text;
    EXPECT_LT(row[4].number, 4.9) << row[0].text;
  }
}

// A fault of 1400 times its bound beside one of six: far from it, the plant's curvature
// fits growth better than chance does.
TEST(RandomFaultStudy, TakesNoFaultOfTheNonlinearMachineForGrowth) {
  LoadedPlan plan = DrawnPlan();
  plan.plan.SetRuns(2);
  plan.plan.seed = 194;
  const std::vector<StudyTable> tables = AnswerTo(plan, {});
  for (const auto& row : tables[0].rows) {
    EXPECT_EQ(row[2].text, "right") << row[9].text << " named " << row[6].text;
  }
}

}  // namespace
}  // namespace mjdiag
