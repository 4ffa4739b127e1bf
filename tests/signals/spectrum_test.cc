#include "mjdiag/signals/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kSampleTime = 1.0 / 8000.0;

VectorXd Sine(Index samples, double amplitude, double frequency) {
  return VectorXd::NullaryExpr(samples, [=](Index k) {
    return amplitude * std::sin(2.0 * std::numbers::pi * frequency * kSampleTime *
                                static_cast<double>(k));
  });
}

TEST(WelchDensity, HoldsThePowerOfASineAtItsFrequency) {
  // 300 Hz lies on bin 75 of 4 Hz.
  const Spectrum spectrum = WelchDensity(Sine(16000, 3.0, 300.0), kSampleTime, 2000);
  EXPECT_DOUBLE_EQ(spectrum.resolution(), 4.0);
  EXPECT_NEAR(BandPower(spectrum, 290.0, 310.0), 4.5, 1e-9);
  EXPECT_NEAR(BandPower(spectrum, 0.0, 4000.0), 4.5, 1e-9);
  EXPECT_NEAR(BandPower(spectrum, 320.0, 4000.0), 0.0, 1e-9);
  const auto peaks = FindPeaks(spectrum, 0.1);
  ASSERT_EQ(peaks.size(), 1U);
  EXPECT_DOUBLE_EQ(peaks[0].frequency, 300.0);
}

TEST(WelchDensity, IsFlatForWhiteNoise) {
  // Density of white noise of variance v at sampling rate fs: 2 v / fs. With half
  // overlap a Hann window leaves N = 1.9 L' independent segments of L' = 256: the total
  // power has relative sd sqrt(2 / 65536) = 0.0055, a bin 1 / sqrt(0.95 * 511) = 0.045.
  std::mt19937_64 random(3);
  std::normal_distribution<double> gaussian(0.0, 2.0);
  const VectorXd noise =
      VectorXd::NullaryExpr(65536, [&](Index) { return gaussian(random); });
  const Spectrum spectrum = WelchDensity(noise, kSampleTime, 256);
  const double expected = 2.0 * 4.0 * kSampleTime;
  EXPECT_NEAR(BandPower(spectrum, 0.0, 4000.0), 4.0, 4.0 * 5.0 * 0.0055);
  for (Index k = 2; k < spectrum.density.size() - 2; ++k) {
    EXPECT_NEAR(spectrum.density[k], expected, 6.0 * 0.045 * expected) << "bin " << k;
  }
}

TEST(WelchDensity, LeavesOutTheMean) {
  const VectorXd constant = VectorXd::Constant(1000, 7.0);
  EXPECT_LT(WelchDensity(constant, kSampleTime, 100).density.maxCoeff(), 1e-25);
}

TEST(WelchDensity, RefusesValuesOutOfRange) {
  const VectorXd signal = VectorXd::Zero(100);
  EXPECT_THROW(WelchDensity(signal, 0.0, 10), InputError);
  EXPECT_THROW(WelchDensity(signal, 1.0, 1), InputError);
  EXPECT_THROW(WelchDensity(signal, 1.0, 101), InputError);
  EXPECT_THROW(WelchDensity(signal, 1.0, 10, 10), InputError);
  EXPECT_NO_THROW(WelchDensity(signal, 1.0, 100, 99));
}

TEST(FindPeaks, FindsMaximaAboveTheThresholdOnly) {
  Spectrum spectrum;
  spectrum.frequency = VectorXd::LinSpaced(10, 0.0, 9.0);
  spectrum.density.resize(10);
  spectrum.density << 5, 1, 4, 4, 1, 2, 3, 1, 0, 9;
  const auto peaks = FindPeaks(spectrum, 3.0);
  ASSERT_EQ(peaks.size(), 3U);
  EXPECT_EQ(peaks[0].frequency, 0.0);
  EXPECT_EQ(peaks[1].frequency, 2.0);
  EXPECT_EQ(peaks[2].frequency, 9.0);
  EXPECT_EQ(peaks[2].density, 9.0);
}

}  // namespace
}  // namespace mjdiag
