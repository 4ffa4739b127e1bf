#include "mjdiag/studies/seen_size.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/preset/preset_plan.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

/// A detector of threshold 1e-3 whose seeds 1 to 40 see sizes from 0.8 to 1.19 of it.
bool Sees(double deviation, std::uint64_t seed) {
  return std::abs(deviation) >= 1e-3 * (0.79 + 0.01 * static_cast<double>(seed));
}

TEST(SizeGrid, HasHalfOfEverySizeAndNoGapAboveItsResolution) {
  for (const double largest : {0.5, -0.5}) {
    const SizeGrid grid(largest, 1.1);
    EXPECT_EQ(grid.At(0), largest);
    for (int size = 0; size < grid.last(); ++size) {
      EXPECT_GT(grid.At(size) / grid.At(size + 1), 1.0);
      EXPECT_LT(grid.At(size) / grid.At(size + 1), 1.1);
      EXPECT_EQ(grid.At(size + 8), 0.5 * grid.At(size));
    }
    EXPECT_LE(grid.At(grid.AtMost(0.3 * largest)) / largest, 0.3);
    EXPECT_GT(grid.At(grid.AtMost(0.3 * largest) - 1) / largest, 0.3);
    EXPECT_EQ(grid.AtMost(3.0 * largest), 0);
    EXPECT_EQ(grid.AtMost(1e-20 * largest), grid.last());
  }
}

TEST(SurelySeenSize, IsWhereAllButTwoOfFortySeedsSeeIt) {
  const SeedsOfASize seeds{40, 1};
  constexpr double kSize = 1e-3 * 1.17;  // seeds 39 and 40 miss it
  EXPECT_EQ(CountSeen(kSize, seeds, Sees), 38);
  EXPECT_EQ(CountSeen(kSize * 0.999, seeds, Sees), 37);
  for (const double largest : {0.5, -0.5}) {
    for (const auto guess :
         {std::optional<double>(), std::optional(std::copysign(1e-5, largest)),
          std::optional(std::copysign(0.4, largest))}) {
      const auto size = SurelySeenSize({largest, 1.05}, guess, seeds, Sees);
      ASSERT_TRUE(size);
      EXPECT_GE(size->deviation / largest, 0.999 * kSize / 0.5);
      EXPECT_LE(size->deviation / largest, 1.05 * kSize / 0.5);
      EXPECT_EQ(size->seeds, CountSeen(size->deviation, seeds, Sees));
    }
  }
}

// What the first sees and what most see is nine sizes of the grid apart, and here each seed
// is harder than all before it: without an order those between ask most of 40 seeds each.
TEST(SurelySeenSize, AsksAllSeedsOnlyWhereMostSeeIt) {
  std::atomic<int> asked = 0;
  const auto sees = [&](double deviation, std::uint64_t seed) {
    ++asked;
    return Sees(deviation, seed);
  };
  ASSERT_TRUE(SurelySeenSize({0.5, 1.05}, {}, {40, 1}, sees));
  const int bisection = 10;
  const int sizes = 9;
  // Three decide, those of the size below are asked before them, and another thread may be
  // at a seed by then. Sizes beyond the smallest that is seen may be tried, too.
  EXPECT_LE(asked, bisection + sizes * 7 + 40);
}

TEST(SurelySeenSize, IsNoneWhereTheLargestIsNotSeenByEnough) {
  const auto most = [](double, std::uint64_t seed) { return seed > 3; };
  EXPECT_FALSE(SurelySeenSize({0.5, 1.1}, {}, {40, 1}, most));
}

TEST(SurelySeenSize, EndsAsSoonAsDecided) {
  std::atomic<int> asked = 0;
  const auto never = [&](double, std::uint64_t) {
    ++asked;
    return false;
  };
  EXPECT_FALSE(SurelySeenSize({0.5, 1.1}, 0.5, {4000, 1}, never));
  EXPECT_LT(asked, 400);  // 201 decide; others may have begun beside them
}

// One fault, two seeds a size, half a second, limits of one motion.
TEST(SmallestSize, PutsTheTwinBesideTheResidualOfTheThesis) {
  const Machine bonder = test::Bonder(
      {"trajectories.multi.duration=0.5", "diagnosis.thresholds.trajectories=[\"x\"]"});
  mjdiag::Setup setup = bonder.setup();
  for (FaultSizes& sizes : setup.studies) {
    if (sizes.name == "largest") sizes.values = {{"eta_x", 0.5}};
    if (sizes.name == "table2") sizes.values = {{"eta_x", 0.995}};
  }
  LoadedPlan plan = ReadPreset("table2", bonder.WithSetup(setup));
  plan.plan.SetRuns(2);
  const auto tables = AnswerTo(plan, {});
  ASSERT_EQ(tables.size(), 3u);
  ASSERT_EQ(tables[0].rows.size(), 3u);
  const auto& residual = tables[0].rows[0];
  const auto& twin = tables[0].rows[2];
  EXPECT_EQ(residual[1].text, "residual");
  EXPECT_EQ(twin[1].text, "twin");
  for (const auto& row : tables[0].rows) {
    EXPECT_EQ(row[3].number, 100.0) << row[1].text;  // at the size of the thesis
    EXPECT_EQ(row[5].number, 100.0) << row[1].text;
    EXPECT_GT(row[7].number, 1.0) << row[1].text;
  }
  EXPECT_GT(twin[7].number, residual[7].number);
  // Naming asks for 4.4 standard deviations; a seed may lie two beyond.
  EXPECT_LT(twin[8].number, 8.0);
  EXPECT_EQ(tables[1].rows.size(), 4u);  // the spectrum is looked at, too
}

}  // namespace
}  // namespace mjdiag
