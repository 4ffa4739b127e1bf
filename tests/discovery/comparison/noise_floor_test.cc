#include "mjdiag/discovery/comparison/noise_floor.h"

#include <gtest/gtest.h>

#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

constexpr Eigen::Index kSamples = 8000;

double Independent(const Eigen::VectorXd& x) {
  return IndependentSamples(PowerSpectrum(x, 1e-3), x.size());
}

// The Welch estimate of S^2 is too large by one part in the number of its averages,
// so the count comes out a little low, never high by more than its scatter.
TEST(IndependentSamples, OfWhiteNoiseAreNearlyAll) {
  const double count = Independent(GaussianNoise(kSamples, 1.0, 1));
  EXPECT_GT(count, 0.75 * kSamples);
  EXPECT_LT(count, 1.01 * kSamples);
}

// The mean square of a first-order process with memory a holds n (1 - a^2) / (1 + a^2)
// independent values.
TEST(IndependentSamples, OfColouredNoiseAreFewer) {
  const double memory = 0.9;
  const double expected = kSamples * (1.0 - memory * memory) / (1.0 + memory * memory);
  const double count = Independent(GaussianNoise(kSamples, 1.0, 1, memory));
  EXPECT_GT(count, 0.65 * expected);
  EXPECT_LT(count, 1.2 * expected);
}

// Level 1 %, 200 draws: more than 8 false alarms have a chance of 2.1e-4. Counting all
// samples as independent would raise the rate of alarms to about 14 %.
TEST(NoiseFloor, OfColouredNoiseIsRarelyExceeded) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Eigen::VectorXd reference = GaussianNoise(kSamples, 1.0, 1000 + seed, 0.9);
    const double freedom = Independent(reference);
    const NoiseFloor floor{Rms(reference), freedom, freedom, {}};
    const Eigen::VectorXd noise = GaussianNoise(kSamples, 1.0, seed, 0.9);
    alarms += NoiseProbability(Rms(noise), floor) < 0.01;
  }
  EXPECT_LE(alarms, 8);
}

TEST(MeasuredNoise, IsFoundInTheRecord) {
  Channels channels;
  channels.sensors = {{"x", "x_encoder", 0, "m", 0.0, 0.0},
                      {"y", "y_encoder", 0, "m", 3e-9, 0.0}};
  Record measured(1e-3);
  const Eigen::ArrayXd phase = Eigen::ArrayXd::LinSpaced(kSamples, 0.0, 50.0);
  measured.Add(
      {"x", "m", 0.01 * phase.sin().matrix() + GaussianNoise(kSamples, 2e-8, 5)});
  const Eigen::VectorXd noise = MeasuredNoise(channels, measured);
  EXPECT_NEAR(noise[0], 2e-8, 0.1 * 2e-8);
  EXPECT_EQ(noise[1], 3e-9) << "y was not measured";
}

}  // namespace
}  // namespace mjdiag
