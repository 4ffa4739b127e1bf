#include "mjdiag/diagnosis/disturbance/tone_magnitude.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "diagnosis/test_noise.h"
#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"
#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using test::residual::Design;
using test::residual::kNoise;
using test::residual::kSamples;
using test::residual::kSampleTime;
using test::residual::kTwoPi;
using test::residual::NoiseSource;
using test::residual::Sine;

/// One-sided density of the noise at a frequency far below the low-pass cut-off.
double NoiseDensity(double frequency) {
  const double gain = std::abs(FrequencyResponse(
      DigitalButterworth(FilterKind::kHighPass, 3, 100.0, kSampleTime), frequency,
      kSampleTime));
  const double low = std::abs(
      FrequencyResponse(DigitalButterworth(FilterKind::kLowPass, 7, 750.0, kSampleTime),
                        frequency, kSampleTime));
  return 2.0 * kNoise * kNoise * kSampleTime * gain * gain * low * low;
}

const VectorXd kFrequency = (VectorXd(3) << 100.0, 300.0, 750.0).finished();

VectorXcd Gain() {
  return (VectorXcd(3) << std::polar(3e-5, 0.4), std::polar(1e-4, -2.0),
          std::polar(2e-5, 1.3))
      .finished();
}

VectorXd Response(double gamma, double start_time = 0.0) {
  VectorXd sum = VectorXd::Zero(kSamples);
  for (Index j = 0; j < 3; ++j) {
    sum += Sine(gamma * std::abs(Gain()[j]), kFrequency[j],
                std::arg(Gain()[j]) + kTwoPi * kFrequency[j] * start_time);
  }
  return sum;
}

/// Lower bound on the sd of gamma: whole record, known density.
double MagnitudeBound() {
  double information = 0.0;
  for (Index j = 0; j < 3; ++j) {
    information += std::norm(Gain()[j]) * kSampleTime * static_cast<double>(kSamples) /
                   NoiseDensity(kFrequency[j]);
  }
  return 1.0 / std::sqrt(information);
}

TEST(ToneMagnitude, IsExactWithoutNoise) {
  NoiseSource noise(17);
  const Spectrum floor = Design(noise).nominal;
  for (const TonePhase phase : {TonePhase::kKnown, TonePhase::kUnknown}) {
    const auto estimate = ToneMagnitude(Response(0.01, 7.3037), kSampleTime, kFrequency,
                                        Gain(), floor, phase, 7.3037);
    // The likelihood of an unknown phase allows for what noise of this sd would add.
    const double noise_share =
        phase == TonePhase::kKnown ? 0.0 : 1.5 * estimate.sd * estimate.sd / 0.01;
    EXPECT_NEAR(estimate.value + noise_share, 0.01, 1e-12 + 0.5 * noise_share);
  }
}

TEST(ToneMagnitude, HasIntervalsThatHold) {
  // 95 % intervals in 200 runs hold in 182 to 197 of them in 99 % of all cases; a
  // window of 4 % and a floor known to 10 % keep the sd within a fifth of the bound.
  NoiseSource noise(18);
  const auto thresholds = Design(noise);
  for (const TonePhase phase : {TonePhase::kKnown, TonePhase::kUnknown}) {
    int covered = 0;
    double squares = 0.0;
    for (int i = 0; i < 200; ++i) {
      const double gamma = std::pow(10.0, -3.5 + 3.0 * noise.Uniform());
      const VectorXd residual = noise.Record() + Response(gamma);
      const auto report = AnalyseDisturbance(residual, kSampleTime, thresholds, {});
      const auto estimate =
          ToneMagnitude(residual, kSampleTime, kFrequency, Gain(), report.floor, phase);
      covered += std::abs(estimate.value - gamma) < 1.96 * estimate.sd;
      squares += std::pow(estimate.value - gamma, 2);
      EXPECT_NEAR(estimate.sd, MagnitudeBound(), 0.2 * MagnitudeBound()) << gamma;
    }
    EXPECT_GE(covered, 182);
    EXPECT_LE(covered, 197);
    // The rms of 200 errors has a relative sd of 5 %.
    EXPECT_NEAR(std::sqrt(squares / 200.0), 1.04 * MagnitudeBound(),
                0.15 * MagnitudeBound());
  }
}

TEST(ToneMagnitude, IsAboutZeroWithoutADisturbance) {
  NoiseSource noise(19);
  const auto thresholds = Design(noise);
  for (int i = 0; i < 20; ++i) {
    const auto estimate = ToneMagnitude(noise.Record(), kSampleTime, kFrequency, Gain(),
                                        thresholds.nominal);
    EXPECT_NEAR(estimate.value, 0.0, 4.0 * estimate.sd);
  }
}

TEST(ToneMagnitude, RefusesWhatItCannotTellApart) {
  NoiseSource noise(20);
  const Spectrum floor = Design(noise).nominal;
  const VectorXd record = noise.Record();
  const auto estimate = [&](std::vector<double> frequency, Index gains) {
    return ToneMagnitude(
        record, kSampleTime,
        Eigen::Map<VectorXd>(frequency.data(), static_cast<Index>(frequency.size())),
        VectorXcd::Ones(gains), floor);
  };
  EXPECT_NO_THROW(estimate({100.0, 100.9}, 2));
  EXPECT_THROW(estimate({100.0, 100.7}, 2), InputError);
  EXPECT_THROW(estimate({0.3}, 1), InputError);
  EXPECT_THROW(estimate({3999.9}, 1), InputError);
  EXPECT_THROW(estimate({100.0, 300.0}, 1), InputError);
  EXPECT_THROW(estimate({}, 0), InputError);
}

}  // namespace
}  // namespace mjdiag
