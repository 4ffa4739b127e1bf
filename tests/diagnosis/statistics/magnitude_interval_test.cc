#include "mjdiag/diagnosis/statistics/magnitude_interval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace mjdiag {
namespace {

// Of 4000 draws each; a count of hits has a standard deviation of sqrt(0.05 0.95 / 4000)
// = 0.0034, and none of the 24 shares is 4 of them off (probability 0.999).
TEST(MagnitudeInterval, HoldsTheMagnitudeAsOftenAsItSaysHoweverSmallItIs) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 4000;
  constexpr double kSd = 0.3;
  constexpr double kChance = 4.0 * 0.0034;
  for (const int parts : {2, 6}) {
    for (const double sigmas :
         {0.0, 0.2, 0.7, 1.2, 1.65, 2.0, 2.5, 3.0, 4.0, 6.0, 29.5, 60.0}) {
      int held = 0;
      for (int draw = 0; draw < kDraws; ++draw) {
        double square = std::pow(sigmas + normal(generator), 2);
        for (int i = 1; i < parts; ++i) square += std::pow(normal(generator), 2);
        const double magnitude = kSd * std::sqrt(std::max(0.0, square - parts));
        const Interval interval = MagnitudeInterval(magnitude, kSd, parts, 0.05);
        EXPECT_LT(interval.min, interval.max);
        if (interval.min <= sigmas * kSd && sigmas * kSd <= interval.max) ++held;
      }
      const double share = static_cast<double>(held) / kDraws;
      EXPECT_GT(share, 0.95 - kChance) << parts << " " << sigmas;
      // None is too large for the interval of noise alone, which is the least that is said,
      // up to 3.2 (two parts) and 3.6 (six) standard deviations.
      EXPECT_LT(share, (sigmas < 3.3 ? 0.975 : 0.95) + kChance)
          << parts << " " << sigmas;
    }
  }
}

TEST(MagnitudeInterval, IsThatOfANormalEstimateWhereTheMagnitudeIsLarge) {
  for (const double magnitude : {29.9, 30.1}) {
    const Interval interval = MagnitudeInterval(magnitude, 1.0, 6, 0.05);
    // The second order of a root, and what is left beyond it.
    EXPECT_NEAR(interval.min, magnitude - 1.95996, 1.2 / 60.0);
    EXPECT_NEAR(interval.max, magnitude + 1.95996, 1.2 / 60.0);
  }
  EXPECT_EQ(MagnitudeInterval(1.0, 0.0, 2, 0.05).min, 1.0);
}

TEST(MagnitudeInterval, IsAllThereIsWhereNothingIsKnown) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const Interval interval = MagnitudeInterval(0.0, kInfinite, 2, 0.05);
  EXPECT_EQ(interval.min, 0.0);
  EXPECT_EQ(interval.max, kInfinite);
}

}  // namespace
}  // namespace mjdiag
