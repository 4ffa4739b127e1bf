#include "mjdiag/discovery/selection/completeness.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

class Completeness : public testing::Test {
 protected:
  test::StageUnderTest stage_;
  DiscoveryProblem problem_ = stage_.Pose(stage_.Measure({}));
  VectorXd noise_ = problem_.Residual({});

  double Value(const VectorXd& innovations) const {
    return NoiseValue(problem_, innovations, {});
  }
};

// p is evenly distributed and the least of two is doubled: one seed of it.
TEST_F(Completeness, NoiseIsLikeNoise) { EXPECT_GT(Value(noise_), 0.01); }

TEST_F(Completeness, AFewPerCentOfAnythingSlowAreNot) {
  VectorXd slow = noise_;
  for (Index k = 0; k < slow.size(); ++k) {
    slow[k] += 0.3 * std::sin(0.05 * static_cast<double>(k));  // 4.5 % of the power
  }
  EXPECT_LT(Value(slow), 1e-4);
}

TEST_F(Completeness, WhatNoFitSawIsAsSmallAsWhatItSaw) {
  VectorXd larger = noise_;
  larger.tail(larger.size() - problem_.train()) *= 1.2;
  EXPECT_LT(Value(larger), 1e-4);
  VectorXd smaller = noise_;
  smaller.tail(smaller.size() - problem_.train()) *= 0.8;
  EXPECT_GT(Value(smaller), 0.01);
  EXPECT_GT(NoiseValue(problem_, noise_, noise_), 0.01);
  EXPECT_LT(NoiseValue(problem_, noise_, 1.2 * noise_), 1e-4);
}

// Noise that is larger than the setup says is noise all the same.
TEST_F(Completeness, TheLevelOfNoiseDoesNotMatter) {
  EXPECT_NEAR(Value(3.0 * noise_), Value(noise_), 1e-9);
}

TEST(ProbabilityOfNoise, FallsWithItsP) {
  EXPECT_DOUBLE_EQ(ProbabilityOfNoise(1.0), ProbabilityOfNoise(0.5));
  EXPECT_GT(ProbabilityOfNoise(0.5), ProbabilityOfNoise(0.01));
  EXPECT_GT(ProbabilityOfNoise(0.01), 0.7);
  EXPECT_LT(ProbabilityOfNoise(1e-6), 0.01);
  EXPECT_EQ(ProbabilityOfNoise(0.0), 0.0);
  EXPECT_TRUE(IsComplete(ProbabilityOfNoise(0.01)));
  EXPECT_FALSE(IsComplete(ProbabilityOfNoise(1e-6)));
}

TEST(AmongAllLaws, ACauseIsNoMoreProbableThanAmongThoseOfTheList) {
  EXPECT_DOUBLE_EQ(AmongAllLaws(0.7, 1.0), 0.7);
  EXPECT_LT(AmongAllLaws(1.0, 0.0), 0.5);
}

}  // namespace
}  // namespace mjdiag
