#include "mjdiag/studies/seen_size.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "mjdiag/studies/detection_study.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

/// A detector of threshold 1e-3 whose seeds 1 to 40 see sizes from 0.8 to 1.19 of it.
bool Sees(double deviation, std::uint64_t seed) {
  return std::abs(deviation) >= 1e-3 * (0.79 + 0.01 * static_cast<double>(seed));
}

TEST(SurelySeenSize, IsWhereAllButTwoOfFortySeedsSeeIt) {
  const SeedsOfASize seeds{40, 1};
  constexpr double kSize = 1e-3 * 1.17;  // seeds 39 and 40 miss it
  EXPECT_EQ(CountSeen(kSize, seeds, Sees), 38);
  EXPECT_EQ(SurelySeen(kSize, seeds, Sees), 38);
  EXPECT_FALSE(SurelySeen(kSize * 0.999, seeds, Sees));
  for (const double largest : {0.5, -0.5}) {
    for (const auto guess :
         {std::optional<double>(), std::optional(std::copysign(1e-5, largest)),
          std::optional(std::copysign(0.4, largest))}) {
      const auto size = SurelySeenSize(largest, guess, 1.05, seeds, Sees);
      ASSERT_TRUE(size);
      EXPECT_GE(size->deviation / largest, 0.999 * kSize / 0.5);
      EXPECT_LE(size->deviation / largest, 1.05 * kSize / 0.5);
      EXPECT_EQ(size->seeds, CountSeen(size->deviation, seeds, Sees));
    }
  }
}

TEST(SurelySeenSize, IsNoneWhereTheLargestIsNotSeenByEnough) {
  const auto most = [](double, std::uint64_t seed) { return seed > 3; };
  EXPECT_FALSE(SurelySeenSize(0.5, {}, 1.1, {40, 1}, most));
}

TEST(SurelySeen, EndsAsSoonAsItIsDecided) {
  std::atomic<int> asked = 0;
  const auto never = [&](double, std::uint64_t) {
    ++asked;
    return false;
  };
  EXPECT_FALSE(SurelySeen(0.5, {4000, 1}, never));
  EXPECT_LT(asked, 400);  // 201 decide; others may have begun beside them
}

// One fault, two seeds a size, half a second, limits of one motion.
TEST(LinearDetectionStudy, PutsTheTwinBesideTheResidualOfTheThesis) {
  const Machine bonder = test::Bonder(
      {"trajectories.multi.duration=0.5", "diagnosis.thresholds.trajectories=[\"x\"]"});
  mjdiag::Setup setup = bonder.setup();
  for (FaultSizes& sizes : setup.studies) {
    if (sizes.name == "largest") sizes.values = {{"eta_x", 0.5}};
    if (sizes.name == "table2") sizes.values = {{"eta_x", 0.995}};
  }
  StudyOptions options;
  options.runs = 2;
  const auto tables = LinearDetectionStudy(bonder.WithSetup(setup), options);
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
