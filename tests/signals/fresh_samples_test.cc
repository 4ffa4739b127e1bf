#include "mjdiag/signals/fresh_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kSamples = 4000;
constexpr double kStep = 1.5e-3;  // of a coarse encoder [rad]

VectorXd Times() { return VectorXd::LinSpaced(kSamples, 0.0, 0.001 * (kSamples - 1)); }

/// Several turns, with rests at the start and in the middle.
VectorXd Motion() {
  return Times().unaryExpr([](double t) {
    const double since = std::max(0.0, t < 2.0 ? t - 0.3 : t - 0.7);
    const double until = t < 2.0 ? std::min(since, 1.3) : since;
    return 1.0 - std::cos(20.0 * until);
  });
}

VectorXd Coarse(const VectorXd& x) { return kStep * (x / kStep).array().round(); }

Index Repeats(const VectorXd& x, double resolution = 0.0) {
  const SampleMask fresh = FindFreshSamples(Times(), x, {resolution, 0.0}).fresh;
  return fresh.size() == 0 ? 0 : fresh.size() - fresh.count();
}

TEST(FreshSamples, AreAllOfAReadingThatRests) {
  EXPECT_EQ(Repeats(Motion()), 0);
  EXPECT_EQ(Repeats(Coarse(Motion()), kStep), 0);
  EXPECT_EQ(Repeats(Coarse(Motion())), 0);
  EXPECT_EQ(Repeats(VectorXd::Constant(kSamples, 0.3)), 0);
}

// What is written with six digits has ten times coarser steps from 1 on.
TEST(FreshSamples, AreAllOfAReadingWithStepsThatGrowWithItsValue) {
  const VectorXd slow = Times().unaryExpr([](double t) {
    const double x = 0.95 + 3e-3 * t + 0.02 * std::sin(0.8 * t) * t;
    const double digit = x < 1.0 ? 1e-6 : 1e-5;
    return digit * std::round(x / digit);
  });
  EXPECT_EQ(Repeats(slow), 0);
}

// Of noise of two steps every seventh difference is none.
TEST(FreshSamples, AreAllOfANoisyCoarseReading) {
  const VectorXd noise = GaussianNoise(kSamples, 2.0 * kStep, 3);
  EXPECT_EQ(Repeats(Coarse(Motion() + noise), kStep), 0);
  const VectorXd fast = 4.0 * kStep / 0.001 * Times();
  EXPECT_EQ(Repeats(Coarse(fast + noise), kStep), 0);
}

// Between its steps the filter leaves what is written with more digits.
TEST(FreshSamples, AreAllOfAnEncoderBehindAFilterThatHardlyMoves) {
  const VectorXd slow = Times().unaryExpr([](double t) {
    return 0.2 + 0.05 * std::sin(2.0 * t) + 0.3 * std::max(0.0, t - 3.0);
  });
  VectorXd x = Coarse(slow);
  double filtered = x[0];
  for (double& value : x) {
    filtered += 0.8 * (value - filtered);
    value = 1e-8 * std::round(1e8 * filtered);
  }
  EXPECT_EQ(Repeats(x), 0);
}

TEST(FreshSamples, AreAllOfAReadingThatStandsStillInItsNoise) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const VectorXd noise = GaussianNoise(kSamples, 1e-5, seed);
    const VectorXd x =
        noise.unaryExpr([](double e) { return 1e-6 * std::round(1e6 * (0.3 + e)); });
    EXPECT_EQ(Repeats(x), 0) << seed;
  }
}

TEST(FreshSamples, AreNotTheRepeatsOfAReadingInMotion) {
  for (const bool coarse : {false, true}) {
    const VectorXd x = coarse ? Coarse(Motion()) : Motion();
    VectorXd repeated = x;
    Index count = 0;
    for (Index k = 400; k < kSamples; k += 17) {
      if (std::abs(x[k] - x[k - 1]) < 4.0 * kStep) continue;
      repeated[k] = repeated[k - 1];
      ++count;
    }
    EXPECT_GT(count, 50);
    EXPECT_NEAR(static_cast<double>(Repeats(repeated, coarse ? kStep : 0.0)),
                static_cast<double>(count), 0.1 * static_cast<double>(count))
        << coarse;
  }
}

TEST(FreshSamples, AreTheFirstOnesOfASlowSensorAlsoAtRest) {
  const VectorXd x = Coarse(Motion());
  VectorXd slow = x;
  for (Index k = 3; k < kSamples; ++k) slow[k] = x[k - (k - 3) % 5];
  const FreshSamples found = FindFreshSamples(Times(), slow, {kStep, 0.0});
  EXPECT_EQ(found.period, 5);
  ASSERT_EQ(found.fresh.size(), kSamples);
  EXPECT_EQ(found.fresh.count(), kSamples / 5);
  EXPECT_TRUE(found.fresh[3]);
}

// A turning constant speed has a beat of its own: one step at a time.
TEST(FreshSamples, AreAllOfACoarseReadingAtConstantSpeed) {
  EXPECT_EQ(Repeats(Coarse(0.2 * kStep / 0.001 * Times()), kStep), 0);
}

TEST(FreshSamples, AreNotThoseOfAReadingThatHangsAndJumps) {
  VectorXd x = Motion() + GaussianNoise(kSamples, 1e-6, 4);
  x.segment(700, 40).setConstant(x[700]);
  EXPECT_EQ(Repeats(x), 39);
}

// Stiction lets go from rest: the first step is no larger than the next ones.
TEST(FreshSamples, AreAllOfAReadingThatSticks) {
  const VectorXd x = Times().unaryExpr([](double t) {
    const double loose = std::fmod(t, 0.4);
    return std::floor(t / 0.4) * 0.16 + 4.0 * std::pow(std::max(0.0, loose - 0.2), 2);
  });
  EXPECT_EQ(Repeats(x), 0);
  EXPECT_EQ(Repeats(Coarse(x), kStep), 0);
}

}  // namespace
}  // namespace mjdiag
