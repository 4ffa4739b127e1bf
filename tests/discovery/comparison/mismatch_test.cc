#include "mjdiag/discovery/comparison/mismatch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mjdiag/signals/error.h"
#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kStep = 1e-3;
constexpr Eigen::Index kSamples = 4000;

Record RecordOf(const Eigen::VectorXd& samples, double step = kStep) {
  Record record(step, 2.0);
  record.Add({"x", "m", samples});
  return record;
}

Eigen::VectorXd Motion() {
  return 0.1 * (Eigen::VectorXd::LinSpaced(kSamples, 0.0, 20.0).array().sin() + 2.0);
}

NoiseFloor FloorOf(double rms, double freedom) { return {rms, freedom, freedom, {}}; }

ChannelMismatch Measure(const Eigen::VectorXd& measured,
                        const Eigen::VectorXd& simulated, const NoiseFloor& floor,
                        const MismatchOptions& options = {}) {
  return MeasureMismatch(RecordOf(measured), RecordOf(simulated), "x", floor, options);
}

// Whatever stands there: a figure has only what was measured.
TEST(Mismatch, IsThatOfSamplesThatWereMeasured) {
  const Eigen::VectorXd noise = GaussianNoise(kSamples, 1e-3, 7);
  Record lacking(kStep, 2.0);
  SampleMask measured = SampleMask::Constant(kSamples, true);
  measured.segment(1000, 500) = false;
  Eigen::VectorXd y = Motion() + noise;
  y.segment(1000, 500).setConstant(9.0);
  lacking.Add({"x", "m", y, measured});
  MismatchOptions options;
  options.skip_samples = 10;
  const NoiseFloor floor = FloorOf(1e-3, kSamples);
  const ChannelMismatch lacks =
      MeasureMismatch(lacking, RecordOf(Motion()), "x", floor, options);
  const Eigen::VectorXd counted =
      Kept(noise, measured).tail(kSamples - 500 - options.skip_samples);
  EXPECT_NEAR(lacks.rms, Rms(counted), 1e-12);
  EXPECT_NEAR(lacks.mae, counted.cwiseAbs().mean(), 1e-12);
  EXPECT_LT(lacks.peak, 1e-2);
  EXPECT_GT(lacks.fit_percent, 98.0);
  EXPECT_LT(lacks.relative_error_percent, 1.0);
  EXPECT_LT(lacks.worst.rms, 2e-3);
  EXPECT_NEAR(lacks.noise_floor.mismatch_freedom,
              kSamples * (1.0 - 500.0 / (kSamples - 10)), 1e-6);
  const ChannelMismatch derived =
      MeasureMismatch(lacking, RecordOf(Motion() + 0.1 * noise), "x", floor, options);
  EXPECT_NEAR(derived.rms, 0.9 * lacks.rms, 1e-12);
}

TEST(Mismatch, IsNothingBetweenEqualRecords) {
  for (const double floor : {0.0, 1e-8}) {
    const ChannelMismatch result =
        Measure(Motion(), Motion(), FloorOf(floor, kSamples));
    EXPECT_EQ(result.rms, 0.0);
    EXPECT_EQ(result.peak, 0.0);
    EXPECT_EQ(result.relative_error_percent, 0.0);
    EXPECT_EQ(result.mae, 0.0);
    EXPECT_EQ(result.fit_percent, 100.0);
    EXPECT_EQ(result.spectrum.density.maxCoeff(), 0.0);
    EXPECT_FALSE(result.exceeds_noise);
  }
}

TEST(Mismatch, FindsAnOffset) {
  const double offset = 3e-8;
  const Eigen::VectorXd measured = Motion().array() + offset;
  const ChannelMismatch result = Measure(measured, Motion(), FloorOf(1e-8, kSamples));
  EXPECT_NEAR(result.rms, offset, 1e-6 * offset);
  EXPECT_NEAR(result.peak, offset, 1e-6 * offset);
  EXPECT_NEAR(
      result.relative_error_percent,
      100.0 * offset * std::sqrt(static_cast<double>(kSamples)) / measured.norm(),
      1e-6 * result.relative_error_percent);
  EXPECT_EQ(result.unit, "m");
  EXPECT_TRUE(result.exceeds_noise);
}

TEST(Mismatch, HasTheFiguresOfOtherTools) {
  const Eigen::VectorXd measured = Motion();
  Eigen::VectorXd simulated = measured;
  simulated.tail(kSamples / 4).array() -= 2e-3;
  const ChannelMismatch result = Measure(measured, simulated, FloorOf(1e-8, kSamples));
  EXPECT_NEAR(result.mae, 0.5e-3, 1e-9);
  EXPECT_NEAR(result.rms, 1e-3, 1e-9);
  const Eigen::VectorXd spread = measured.array() - measured.mean();
  EXPECT_NEAR(result.fit_percent,
              100.0 * (1.0 - (measured - simulated).norm() / spread.norm()), 1e-9);
  // The mean of what was measured explains nothing.
  simulated.setConstant(measured.mean());
  EXPECT_NEAR(Measure(measured, simulated, FloorOf(1e-8, kSamples)).fit_percent, 0.0,
              1e-9);
}

TEST(Mismatch, LeavesOutTheStart) {
  Eigen::VectorXd measured = Motion();
  measured.head(49).setConstant(7.0);
  MismatchOptions options;
  options.skip_samples = 49;
  const ChannelMismatch result =
      Measure(measured, Motion(), FloorOf(1e-8, kSamples), options);
  EXPECT_EQ(result.rms, 0.0);
  EXPECT_EQ(result.peak, 0.0);
  EXPECT_EQ(result.relative_error_percent, 0.0);
  EXPECT_FALSE(result.exceeds_noise);
}

TEST(Mismatch, FindsTheWorstWindow) {
  Eigen::VectorXd measured = Motion();
  const Eigen::Index first = 2500;
  measured[100] += 2e-3;  // a larger peak that holds less energy
  measured.segment(first, 100).array() += 1e-3;
  MismatchOptions options;
  options.skip_samples = 20;
  options.window = 0.1;
  const ChannelMismatch result =
      Measure(measured, Motion(), FloorOf(1e-6, kSamples), options);
  EXPECT_NEAR(result.worst.start, 2.0 + first * kStep, 1e-9);
  EXPECT_NEAR(result.worst.duration, 0.1, 1e-9);
  EXPECT_NEAR(result.worst.rms, 1e-3, 1e-12);
  EXPECT_NEAR(result.peak, 2e-3, 1e-12);
}

TEST(Mismatch, SpectrumShowsTheFrequencyOfTheError) {
  const double frequency = 100.0;
  const double last = 2.0 * M_PI * frequency * kStep * (kSamples - 1);
  const Eigen::VectorXd measured =
      Motion().array() + 1e-6 * Eigen::ArrayXd::LinSpaced(kSamples, 0.0, last).sin();
  const Spectrum spectrum =
      Measure(measured, Motion(), FloorOf(1e-8, kSamples)).spectrum;
  Eigen::Index peak = 0;
  spectrum.density.maxCoeff(&peak);
  const double resolution = spectrum.frequency[1] - spectrum.frequency[0];
  EXPECT_THAT(spectrum.frequency[peak], DoubleNear(frequency, resolution));
}

// Upper 1 % points of the F distribution from tables.
TEST(NoiseProbability, AgreesWithTablesOfTheFDistribution) {
  struct Point {
    double freedom, floor_freedom, quantile;
  };
  for (const Point& point : {Point{5, 10, 5.6363}, Point{10, 20, 3.3682},
                             Point{100, 100, 1.5977}, Point{24000, 2000, 1.0808}}) {
    const NoiseFloor floor{1.0, point.freedom, point.floor_freedom, {}};
    EXPECT_NEAR(NoiseProbability(std::sqrt(point.quantile), floor), 0.01, 5e-4)
        << point.freedom << ", " << point.floor_freedom;
  }
}

TEST(NoiseProbability, OfAChannelWithoutNoiseIsZeroForAnyMismatch) {
  EXPECT_EQ(NoiseProbability(1e-12, FloorOf(0.0, 100)), 0.0);
  EXPECT_EQ(NoiseProbability(0.0, FloorOf(0.0, 100)), 1.0);
}

// Level 1 %, 200 draws: more than 8 false alarms have a chance of 2.5e-4.
TEST(Mismatch, OfWhiteNoiseRarelyExceedsItsFloor) {
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const double floor = Rms(GaussianNoise(kSamples, 1e-8, 1000 + seed));
    const Eigen::VectorXd noise = GaussianNoise(kSamples, 1e-8, seed);
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(kSamples);
    alarms += Measure(noise, still, FloorOf(floor, kSamples)).exceeds_noise;
  }
  EXPECT_LE(alarms, 8);
}

// ln F has a standard deviation of sqrt(4 / 4000). 10 % more rms than the floor lies 6
// of them above 0, the level 2.3: a draw misses it with a chance of 1e-4, and 3 of 200
// draws with one of 1e-6.
TEST(Mismatch, SlightlyLargerThanNoiseExceedsItsFloor) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const double floor = Rms(GaussianNoise(kSamples, 1e-8, 1000 + seed));
    const Eigen::VectorXd noise = GaussianNoise(kSamples, 1.1e-8, seed);
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(kSamples);
    found += Measure(noise, still, FloorOf(floor, kSamples)).exceeds_noise;
  }
  EXPECT_GE(found, 198);
}

TEST(Mismatch, RefusesRecordsThatDoNotMatch) {
  const NoiseFloor floor = FloorOf(1e-8, kSamples);
  const Record record = RecordOf(Motion());
  EXPECT_THAT(
      [&] { MeasureMismatch(record, RecordOf(Motion().head(10)), "x", floor, {}); },
      ThrowsMessage<InputError>(HasSubstr("4000 and 10 samples")));
  EXPECT_THAT(
      [&] { MeasureMismatch(record, RecordOf(Motion(), 2e-3), "x", floor, {}); },
      ThrowsMessage<InputError>(HasSubstr("equal sample times")));
  MismatchOptions options;
  options.skip_samples = kSamples;
  EXPECT_THAT([&] { MeasureMismatch(record, record, "x", floor, options); },
              ThrowsMessage<InputError>(HasSubstr("4000 are left out")));
}

TEST(RelativeError, IsInfiniteAgainstNothing) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(3);
  EXPECT_EQ(RelativeErrorPercent(zero, one, 0),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(RelativeErrorPercent(one, zero, 0), 100.0);
}

}  // namespace
}  // namespace mjdiag
