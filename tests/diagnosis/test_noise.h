#pragma once
// Disturbance residuals for the tests of this folder: filtered noise and sines, 8 kHz.

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"
#include "mjdiag/signals/butterworth.h"

namespace mjdiag::test::residual {

inline constexpr double kSampleTime = 1.0 / 8000.0;
inline constexpr Eigen::Index kSamples = 20000;  // 2.5 s: eight segments of 4096
inline constexpr double kNoise = 20e-9;          // m
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Noise as a disturbance residual has it: white sensor noise through a high-pass and a
/// low-pass filter. Its density spans ten decades between 300 Hz and 3.5 kHz.
class NoiseSource {
 public:
  explicit NoiseSource(unsigned seed) : random_(seed) {}

  Eigen::VectorXd Record(double sd = kNoise, Eigen::Index samples = kSamples) {
    SectionFilter high(
        DigitalButterworth(FilterKind::kHighPass, 3, 100.0, kSampleTime));
    SectionFilter low(DigitalButterworth(FilterKind::kLowPass, 7, 750.0, kSampleTime));
    constexpr Eigen::Index kSettling = 2000;
    Eigen::VectorXd record(samples);
    for (Eigen::Index k = -kSettling; k < samples; ++k) {
      const double value = low.Update(high.Update(sd * gaussian_(random_)));
      if (k >= 0) record[k] = value;
    }
    return record;
  }

  Eigen::VectorXd White(double sd = kNoise, Eigen::Index samples = kSamples) {
    return Eigen::VectorXd::NullaryExpr(
        samples, [&](Eigen::Index) { return sd * gaussian_(random_); });
  }

  double Uniform() { return std::uniform_real_distribution<double>()(random_); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> gaussian_;
};

inline Eigen::VectorXd Sine(double amplitude, double frequency, double phase = 0.0,
                            Eigen::Index samples = kSamples) {
  return Eigen::VectorXd::NullaryExpr(samples, [=](Eigen::Index k) {
    return amplitude *
           std::sin(kTwoPi * frequency * kSampleTime * static_cast<double>(k) + phase);
  });
}

inline DisturbanceThresholds Design(NoiseSource& noise,
                                    const DisturbanceOptions& options = {}) {
  std::vector<Eigen::VectorXd> nominal(5);
  for (Eigen::VectorXd& run : nominal) run = noise.Record();
  return DesignDisturbanceThresholds(nominal, kSampleTime, options);
}

}  // namespace mjdiag::test::residual
