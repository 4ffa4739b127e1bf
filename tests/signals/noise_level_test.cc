#include "mjdiag/signals/noise_level.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kSamples = 20000;
constexpr double kNoise = 1e-8;
/// Five standard deviations of the estimate, 1.2 sqrt(6 / 20000) = 0.021 for order 6
/// (1.3 sqrt(m / samples) at most, which is less for lower and 0.018 for order 12).
constexpr double kBound = 5.0 * 0.021;

VectorXd Gaussian(double sd) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> gaussian(0.0, sd);
  return VectorXd::NullaryExpr(kSamples, [&](Index) { return gaussian(random); });
}

/// 4 mm of motion and 1 um of vibration at 300 Hz, sampled at 8 kHz.
VectorXd Motion() {
  return VectorXd::NullaryExpr(kSamples, [](Index k) {
    const double t = static_cast<double>(k) / 8000.0;
    return 4e-3 * std::sin(2.0 * std::numbers::pi * 3.0 * t) +
           1e-6 * std::sin(2.0 * std::numbers::pi * 300.0 * t);
  });
}

TEST(NoiseLevel, IsTheStandardDeviationOfWhiteNoise) {
  for (int order = 1; order <= 12; ++order) {
    EXPECT_NEAR(NoiseLevel(Gaussian(2.0), order), 2.0, 2.0 * kBound) << order;
  }
}

TEST(NoiseLevel, DoesNotSeeSmoothMotion) {
  EXPECT_NEAR(NoiseLevel(Motion() + Gaussian(kNoise)), kNoise, kBound * kNoise);
  EXPECT_LT(NoiseLevel(Motion()), 0.02 * kNoise);
}

TEST(NoiseLevel, ShrugsOffImpacts) {
  VectorXd signal = Motion() + Gaussian(kNoise);
  // An impact a hundred samples touches 7 % of the differences, which moves the median
  // by less than 0.07 / (2 * 0.32) = 11 % of sigma (density of |e| at its median).
  for (Index k = 50; k < kSamples; k += 100) signal[k] += 1e-3;
  EXPECT_NEAR(NoiseLevel(signal), kNoise, (0.11 + kBound) * kNoise);
}

TEST(NoiseLevel, AddsTheQuantisationThatNoiseDithers) {
  constexpr double kStep = 1e-6;
  const VectorXd quantised =
      ((Motion() + Gaussian(kStep)) / kStep).array().round().matrix() * kStep;
  const double expected = kStep * std::sqrt(1.0 + 1.0 / 12.0);
  EXPECT_NEAR(NoiseLevel(quantised), expected, kBound * expected);
}

TEST(NoiseLevel, IsZeroForASignalThatRestsMostOfTheTime) {
  VectorXd signal = VectorXd::Zero(kSamples);
  signal.head(100) = Gaussian(1.0).head(100);
  EXPECT_EQ(NoiseLevel(signal), 0.0);
}

TEST(NoiseLevel, RefusesValuesOutOfRange) {
  EXPECT_THROW(NoiseLevel(VectorXd::Zero(100), 0), InputError);
  EXPECT_THROW(NoiseLevel(VectorXd::Zero(100), 13), InputError);
  EXPECT_THROW(NoiseLevel(VectorXd::Zero(8)), InputError);
  EXPECT_EQ(NoiseLevel(VectorXd::Zero(9)), 0.0);
}

}  // namespace
}  // namespace mjdiag
