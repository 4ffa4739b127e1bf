#include "mjdiag/studies/random_fault.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/random_fault_study.h"
#include "support/bonder.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

const DrawRange& RangeOf(const std::vector<DrawRange>& ranges,
                         const std::string& name) {
  return *std::ranges::find(ranges, name, &DrawRange::name);
}

TEST(DrawRanges, AreThoseOfTheSetup) {
  const Machine machine = test::Bonder();
  const std::vector<DrawRange> ranges = DrawRanges(machine.setup());
  ASSERT_EQ(ranges.size(), 8u);
  const DrawRange& zeta = RangeOf(ranges, "zeta_x");
  EXPECT_NEAR(zeta.least, 1e-5, 1e-15);
  EXPECT_DOUBLE_EQ(zeta.below, 0.5);
  EXPECT_DOUBLE_EQ(zeta.above, 1.0);
  EXPECT_EQ(RangeOf(ranges, "beta_y").above, 0.0);
  EXPECT_EQ(RangeOf(ranges, "gamma").healthy, 0.0);
}

TEST(DrawRanges, RefuseOneThatLeavesNothing) {
  const Machine machine = test::Bonder({"studies.random_least.beta_x=0.2"});
  EXPECT_EQ(test::MessageOf<InputError>([&] { DrawRanges(machine.setup()); }),
            "studies.random_least.beta_x: leaves nothing to be drawn; expected a value "
            "between healthy and random_low or random_high");
}

// Of 2000 draws: shares within 4 binomial standard deviations, of at most
// sqrt(0.25 / 2000) = 0.011 each.
TEST(DrawFaults, IsEvenOverNumbersSidesSizesAndStarts) {
  constexpr int kDraws = 2000;
  constexpr double kBand = 4.0 * 0.0112;
  const Machine machine = test::Bonder();
  const std::vector<DrawRange> ranges = DrawRanges(machine.setup());
  std::array<double, 4> counts{};
  double from_rest = 0.0;
  double faults = 0.0;
  double small = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const RandomDraw draw = DrawFaults(ranges, 20000, static_cast<std::uint64_t>(i));
    counts.at(draw.faults.size()) += 1.0 / kDraws;
    from_rest += draw.from == 0 ? 1.0 / kDraws : 0.0;
    EXPECT_LT(draw.from, 10000);
    std::set<std::string> names;
    for (const SizedFault& fault : draw.faults) {
      names.insert(fault.name);
      const DrawRange& range = RangeOf(ranges, fault.name);
      const double away = fault.value - range.healthy;
      EXPECT_GE(std::abs(away), range.least * (1.0 - 1e-9));
      EXPECT_LE(away, range.above);
      EXPECT_GE(away, -range.below);
      const double most = away > 0.0 ? range.above : range.below;
      ++faults;
      small += std::abs(away) < std::sqrt(range.least * most) ? 1.0 : 0.0;
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
  const Machine machine = test::Bonder({"trajectories.multi.duration=1"});
  StudyOptions options;
  options.runs = 6;
  options.linear = true;
  std::size_t shown = 0;
  options.row = [&](const StudyTable& table) { shown = table.rows.size(); };
  const std::vector<StudyTable> tables = RandomFaultStudy(machine, options);
  EXPECT_EQ(shown, 6u);
  for (const auto& row : tables[0].rows) {
    EXPECT_EQ(row[2].text, "right") << row[9].text << " named " << row[6].text;
    EXPECT_LT(row[4].number, 4.9) << row[0].text;
  }
}

// A fault of 1400 times its bound beside one of six: far from it, the plant's curvature
// fits growth better than chance does.
TEST(RandomFaultStudy, TakesNoFaultOfTheNonlinearMachineForGrowth) {
  const Machine machine = test::Bonder();
  StudyOptions options;
  options.runs = 2;
  options.seed = 194;
  const std::vector<StudyTable> tables = RandomFaultStudy(machine, options);
  for (const auto& row : tables[0].rows) {
    EXPECT_EQ(row[2].text, "right") << row[9].text << " named " << row[6].text;
  }
}

}  // namespace
}  // namespace mjdiag
