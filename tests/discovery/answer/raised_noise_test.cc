#include "mjdiag/discovery/answer/raised_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/gaussian_noise.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

constexpr Eigen::Index kSamples = 20000;

/// Innovations of the stage, 10 nm of noise in its setup, as an observer that follows
/// nothing would have them.
std::vector<RaisedNoise> FindIn(const Eigen::VectorXd& innovations) {
  const test::Stage stage;
  Observer observer;
  observer.noise_sd = Eigen::VectorXd::Constant(1, 1e-8);
  observer.innovation_sd = observer.noise_sd;
  return FindRaisedNoise(stage.setup(), observer, innovations.transpose(), 1.0);
}

TEST(RaisedNoise, WhiteNoiseBeyondTheSetupIsFoundWithItsSize) {
  const auto found = FindIn(GaussianNoise(kSamples, 1.5e-8, 1));
  ASSERT_EQ(found.size(), 1u);
  // sqrt(1.5^2 - 1^2); three of its own standard deviations.
  EXPECT_NEAR(found[0].sd, 1.118e-8, 3.0 * found[0].sd_error);
  EXPECT_LT(found[0].sd_error, 2e-10);
}

TEST(RaisedNoise, NoiseOfTheSetupIsNoCause) {
  EXPECT_TRUE(FindIn(GaussianNoise(kSamples, 1e-8, 2)).empty());
}

// As strong as above in all, but slow: what a model lacks, not what a sensor does.
TEST(RaisedNoise, ASlowRestIsNoSensorNoise) {
  const Eigen::VectorXd rest =
      GaussianNoise(kSamples, 1e-8, 3) + GaussianNoise(kSamples, 1.118e-8, 4, 0.95);
  EXPECT_TRUE(FindIn(rest).empty());
}

// As strong as above in all, and white, but in a tenth of the time only.
TEST(RaisedNoise, ARestThatComesAndGoesIsNoSensorNoise) {
  Eigen::VectorXd more = GaussianNoise(kSamples, 1.118e-8 * std::sqrt(10.0), 6);
  for (Eigen::Index k = 0; k < kSamples; ++k) {
    if (k % 1000 >= 100) more[k] = 0.0;
  }
  EXPECT_TRUE(FindIn(GaussianNoise(kSamples, 1e-8, 5) + more).empty());
}

// 200 draws; of white noise five standard deviations are met by chance once in 10^5.
TEST(RaisedNoise, WhiteNoiseIsSteady) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    EXPECT_EQ(FindIn(GaussianNoise(kSamples, 1.2e-8, seed)).size(), 1u) << seed;
  }
}

}  // namespace
}  // namespace mjdiag
