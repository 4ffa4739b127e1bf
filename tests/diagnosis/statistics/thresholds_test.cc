#include "mjdiag/diagnosis/statistics/thresholds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd Normal(Index samples, double mean, double sd, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(mean, sd);
  return VectorXd::NullaryExpr(samples, [&] { return normal(generator); });
}

TEST(ThresholdsByMargin, AreEquation21OverAllRuns) {
  const ThresholdDesign design =
      ThresholdsByMargin({Vector3d(-1.0, 0.5, 2.0), Vector3d(-3.0, 0.0, 1.0)}, 2.0);
  EXPECT_DOUBLE_EQ(design.limits.min, -6.0);
  EXPECT_DOUBLE_EQ(design.limits.max, 4.0);
  EXPECT_DOUBLE_EQ(design.alpha, 2.0);
}

TEST(ThresholdsByMargin, RefuseNoRunAndAMarginBelowOne) {
  EXPECT_THROW(ThresholdsByMargin({}, 2.0), InputError);
  EXPECT_THROW(ThresholdsByMargin({VectorXd()}, 2.0), InputError);
  EXPECT_THROW(ThresholdsByMargin({Vector3d::Ones()}, 0.99), InputError);
  EXPECT_THROW(ThresholdsByMargin({Vector3d::Ones()}, std::nan("")), InputError);
}

TEST(Interval, HoldsWhatIsInsideOnly) {
  const Interval interval{-1.0, 2.0};
  EXPECT_TRUE(interval.Holds(0.0));
  EXPECT_FALSE(interval.Holds(-1.0));
  EXPECT_FALSE(interval.Holds(2.0));
  EXPECT_FALSE(interval.Holds(std::nan("")));
}

TEST(ThresholdsByFalseAlarms, AreKeptAtTheWantedRate) {
  // Runs of 1000 independent samples at 5 %: of 2000 runs 100 leave the limits, with a
  // standard deviation of 9.7; four of these are allowed. Bonferroni's bound is 2.5 %
  // of itself above the true rate, the fit's error on 200000 samples moves the rate by
  // 3 %: together less than one more.
  constexpr Index kSamples = 1000;
  constexpr int kRuns = 2000;
  const ThresholdDesign design =
      ThresholdsByFalseAlarms({Normal(200'000, 0.7, 2.0, 1)}, 0.05, kSamples);
  EXPECT_NEAR(design.fit.mean, 0.7, 5.0 * 2.0 / std::sqrt(200'000.0));
  EXPECT_NEAR(design.fit.sd, 2.0, 5.0 * 2.0 / std::sqrt(400'000.0));
  int alarms = 0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const VectorXd residual = Normal(kSamples, 0.7, 2.0, 100 + run);
    if (!design.limits.Holds(residual.minCoeff()) ||
        !design.limits.Holds(residual.maxCoeff())) {
      ++alarms;
    }
  }
  EXPECT_NEAR(alarms, 100, 5.0 * 9.7);
}

TEST(ThresholdsByFalseAlarms, GiveTheMarginToWhichTheyAmount) {
  const VectorXd nominal = Normal(1000, 0.0, 1.0, 3);
  const ThresholdDesign design = ThresholdsByFalseAlarms({nominal}, 1e-3, 1e5);
  EXPECT_DOUBLE_EQ(design.alpha, std::max(design.limits.max / nominal.maxCoeff(),
                                          design.limits.min / nominal.minCoeff()));
  EXPECT_GT(design.alpha, 1.0);
}

TEST(ThresholdsByFalseAlarms, RefuseARateThatIsNoProbability) {
  for (const double rate : {0.0, 1.0, -0.1, std::nan("")}) {
    EXPECT_THROW(ThresholdsByFalseAlarms({Vector3d::Ones()}, rate, 10), InputError);
  }
}

TEST(Histogram, CountsEverySampleOnceAndInItsBin) {
  const VectorXd nominal = Normal(5000, 0.0, 1.0, 4);
  const Histogram histogram =
      ThresholdsByMargin({nominal.head(2000), nominal.tail(3000)}, 2.0).histogram;
  ASSERT_EQ(histogram.edges.size(), histogram.count.size() + 1);
  EXPECT_DOUBLE_EQ(histogram.edges.front(), nominal.minCoeff());
  EXPECT_NEAR(histogram.edges.back(), nominal.maxCoeff(), 1e-12);
  EXPECT_EQ(std::accumulate(histogram.count.begin(), histogram.count.end(), Index{0}),
            5000);
  for (const std::size_t bin : {0, 20, 30, 45}) {
    const Index expected = (nominal.array() >= histogram.edges[bin] &&
                            nominal.array() < histogram.edges[bin + 1])
                               .count();
    EXPECT_EQ(histogram.count[bin], expected) << bin;
  }
}

TEST(Histogram, OfAConstantResidualIsOneBin) {
  const Histogram histogram =
      ThresholdsByMargin({Vector3d::Constant(0.5)}, 1.0).histogram;
  EXPECT_EQ(histogram.count.front(), 3);
}

}  // namespace
}  // namespace mjdiag
