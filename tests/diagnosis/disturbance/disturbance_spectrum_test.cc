#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/test_noise.h"
#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/median.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;
using test::residual::Design;
using test::residual::kNoise;
using test::residual::kSamples;
using test::residual::kSampleTime;
using test::residual::kTwoPi;
using test::residual::NoiseSource;
using test::residual::Sine;

TEST(DisturbanceThresholds, AreTheHighestNominalValuesWithTheirMargins) {
  NoiseSource noise(1);
  std::vector<VectorXd> nominal{noise.Record(), noise.Record(2.0 * kNoise),
                                noise.Record()};
  DisturbanceOptions options;
  options.peak_margin = 0.5;
  options.total_margin = 0.1;
  options.low = 50.0;
  options.high = 2000.0;
  const auto thresholds = DesignDisturbanceThresholds(nominal, kSampleTime, options);
  const Spectrum loudest = WelchDensity(nominal[1], kSampleTime, 4096);
  EXPECT_DOUBLE_EQ(thresholds.peak, 1.5 * loudest.density.maxCoeff());
  EXPECT_DOUBLE_EQ(thresholds.total, 1.1 * BandPower(loudest, 50.0, 2000.0));
  // Its noise is 4 times the others', so 2 times the mean of all three. The median of
  // 8 segments of 1000 bins scatters by 4 %; the mean run takes part in itself.
  EXPECT_NEAR(thresholds.noise_ratio, 1.1 * 2.0, 0.2 * 2.0);
  // Eight segments: 36 * 64 / 151 each.
  EXPECT_NEAR(thresholds.nominal_dof, 3.0 * 2304.0 / 151.0, 1e-9);
}

TEST(AnalyseDisturbance, RaisesNoFalseAlarm) {
  // A tone in one of 200 records has probability 1 % at 1e-4 a record, two 0.02 %.
  // Total and noise have margins of 25 % where both scatter by less than 5 %.
  NoiseSource noise(2);
  const auto thresholds = Design(noise);
  int with_tones = 0;
  int raised = 0;
  int over_total = 0;
  for (int i = 0; i < 200; ++i) {
    const auto report = AnalyseDisturbance(noise.Record(), kSampleTime, thresholds, {});
    with_tones += report.tones.empty() ? 0 : 1;
    raised += report.noise_raised ? 1 : 0;
    over_total += report.total > report.total_threshold ? 1 : 0;
  }
  EXPECT_LE(with_tones, 1);
  EXPECT_EQ(raised, 0);
  EXPECT_EQ(over_total, 0);
}

TEST(AnalyseDisturbance, StaysBelowTheWantedFalseAlarmProbability) {
  // At 30 % a record, 200 records have tones in at most 60 + 2.6 * 6.5 = 77 of them
  // (99.5 % of a binomial distribution). White noise, one nominal run: its scatter,
  // too, must be allowed for, and no margin helps.
  NoiseSource noise(3);
  DisturbanceOptions options;
  options.tone_false_alarm = 0.3;
  options.peak_margin = 0.0;
  int with_tones = 0;
  for (int i = 0; i < 200; ++i) {
    const std::vector<VectorXd> nominal{noise.White()};
    const auto thresholds = DesignDisturbanceThresholds(nominal, kSampleTime, options);
    const auto report =
        AnalyseDisturbance(noise.White(), kSampleTime, thresholds, options);
    with_tones += report.tones.empty() ? 0 : 1;
  }
  EXPECT_LE(with_tones, 77);
}

TEST(AnalyseDisturbance, CallsTenfoldNoiseNoiseAndNotTones) {
  NoiseSource noise(4);
  const auto thresholds = Design(noise);
  for (int i = 0; i < 20; ++i) {
    const auto report =
        AnalyseDisturbance(noise.Record(10.0 * kNoise), kSampleTime, thresholds, {});
    EXPECT_TRUE(report.noise_raised);
    EXPECT_TRUE(report.disturbed);
    EXPECT_GT(report.total, report.total_threshold);
    EXPECT_TRUE(report.tones.empty());
    // Eq. 29 alone would see a peak at most frequencies of the pass band.
    EXPECT_GT(Median(report.spectrum.density.segment(100, 200)), thresholds.peak);
    // The medians of 1500 bins scatter by 3 % a segment and 1.5 % in the nominal runs.
    EXPECT_NEAR(report.noise_ratio, 100.0, 10.0);
  }
}

TEST(AnalyseDisturbance, FindsAToneInTenfoldNoise) {
  NoiseSource noise(5);
  const auto thresholds = Design(noise);
  // 1.5 times the noise's rms of 27e-9 * sqrt(100) over a line of 3 Hz.
  const double amplitude = 60e-9;
  for (int i = 0; i < 20; ++i) {
    const VectorXd residual =
        noise.Record(10.0 * kNoise) + Sine(amplitude, 301.3, kTwoPi * noise.Uniform());
    const auto report = AnalyseDisturbance(residual, kSampleTime, thresholds, {});
    EXPECT_TRUE(report.noise_raised);
    ASSERT_EQ(report.tones.size(), 1U);
    const DisturbanceTone& tone = report.tones[0];
    EXPECT_NEAR(tone.frequency, 301.3, 5.0 * tone.frequency_sd);
    EXPECT_NEAR(tone.amplitude, amplitude, 5.0 * tone.amplitude_sd);
    EXPECT_GT(tone.psd, tone.threshold);
  }
}

TEST(AnalyseDisturbance, FindsTheThreeTonesOfTheSeedAndNoOthers) {
  // From 30 to 3e6 in amplitude over a density at 300 Hz that holds 2e-10 m in a line:
  // the disturbance sets in at t = 0, so the record begins with the filters' transient.
  NoiseSource noise(6);
  const auto thresholds = Design(noise);
  SectionFilter high(DigitalButterworth(FilterKind::kHighPass, 3, 100.0, kSampleTime));
  SectionFilter low(DigitalButterworth(FilterKind::kLowPass, 7, 750.0, kSampleTime));
  VectorXd unit = Sine(1.0, 100.0) + Sine(1.0, 300.0) + Sine(1.0, 750.0);
  for (double& value : unit) value = low.Update(high.Update(value));
  for (const double amplitude : {6e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 6e-4}) {
    const auto report = AnalyseDisturbance(noise.Record() + amplitude * unit,
                                           kSampleTime, thresholds, {});
    ASSERT_EQ(report.tones.size(), 3U) << amplitude;
    EXPECT_FALSE(report.noise_raised) << amplitude << " " << report.noise_ratio;
    int i = 0;
    for (const double frequency : {100.0, 300.0, 750.0}) {
      // The transient shifts strong lines by a hundred-thousandth of a bin.
      EXPECT_NEAR(report.tones[static_cast<std::size_t>(i++)].frequency, frequency,
                  std::max(2e-5, 5e-10 / amplitude));
    }
  }
}

TEST(AnalyseDisturbance, HasNoNeighboursOfAStrongTone) {
  // Off the bins, on a bin, and near both ends of the band; up to 1e11 times the floor.
  NoiseSource noise(7);
  const auto thresholds = Design(noise);
  for (const double amplitude : {1e-7, 1e-5, 1e-3}) {
    for (const double frequency : {20.3, 100.4, 301.0, 300.78125, 1499.3, 3950.7}) {
      const auto report =
          AnalyseDisturbance(noise.Record() + Sine(amplitude, frequency, 1.0),
                             kSampleTime, thresholds, {});
      ASSERT_EQ(report.tones.size(), 1U) << amplitude << " m at " << frequency << " Hz";
      // At 20 Hz the line at negative frequency, 100 resolutions away, leaks 3e-7.
      EXPECT_NEAR(report.tones[0].frequency, frequency,
                  std::max(1e-7, 6.0 * report.tones[0].frequency_sd));
      EXPECT_NEAR(report.tones[0].amplitude, amplitude, 1e-9);
    }
  }
}

TEST(AnalyseDisturbance, FindsAWeakToneBesideAStrongOne) {
  NoiseSource noise(8);
  const auto thresholds = Design(noise);
  const VectorXd residual = noise.Record() + Sine(1e-6, 301.4) + Sine(3e-9, 332.0, 2.0);
  const auto report = AnalyseDisturbance(residual, kSampleTime, thresholds, {});
  ASSERT_EQ(report.tones.size(), 2U);
  EXPECT_NEAR(report.tones[1].frequency, 332.0, 0.2);
}

TEST(AnalyseDisturbance, FindsWeakTonesThatTheGlobalPeakThresholdHides) {
  NoiseSource noise(9);
  const auto thresholds = Design(noise);
  const double amplitude = 5e-11;
  const auto report = AnalyseDisturbance(noise.Record() + Sine(amplitude, 1602.2),
                                         kSampleTime, thresholds, {});
  ASSERT_EQ(report.tones.size(), 1U);
  const DisturbanceTone& tone = report.tones[0];
  EXPECT_NEAR(tone.frequency, 1602.2, 5.0 * tone.frequency_sd);
  EXPECT_FALSE(tone.above_peak);
  EXPECT_LT(tone.psd, 1e-2 * thresholds.peak);
  EXPECT_GT(tone.psd, tone.threshold);
  EXPECT_FALSE(report.noise_raised);
  EXPECT_TRUE(report.disturbed);
}

TEST(AnalyseDisturbance, TakesNominalLinesForNominal) {
  // Five nominal runs with a comb at the multiples of a move's 8.7 Hz, of levels that
  // differ by the run; the next runs have it at levels in between.
  NoiseSource noise(10);
  const auto comb = [&](double level) {
    VectorXd sum = VectorXd::Zero(kSamples);
    for (int i = 1; i <= 40; ++i) sum += Sine(level / i, 8.7 * i, i);
    return sum;
  };
  std::vector<VectorXd> nominal;
  for (const double level : {1e-7, 2e-7, 3e-7, 4e-7, 5e-7}) {
    nominal.emplace_back(noise.Record() + comb(level));
  }
  const auto thresholds = DesignDisturbanceThresholds(nominal, kSampleTime, {});
  for (int i = 0; i < 50; ++i) {
    const double level = 1e-7 + 4e-7 * noise.Uniform();
    const auto report =
        AnalyseDisturbance(noise.Record() + comb(level), kSampleTime, thresholds, {});
    EXPECT_TRUE(report.tones.empty()) << level;
    EXPECT_FALSE(report.disturbed) << level;
  }
  // A tone between the lines is none of them.
  const auto report = AnalyseDisturbance(
      noise.Record() + comb(2e-7) + Sine(1e-7, 500.3), kSampleTime, thresholds, {});
  ASSERT_EQ(report.tones.size(), 1U);
  EXPECT_NEAR(report.tones[0].frequency, 500.3, 0.01);
}

TEST(AnalyseDisturbance, TakesLinesOfASingleNominalRunForNominal) {
  // One trajectory of ten has lines, ten times the mean of all: as far from it as a
  // tone.
  NoiseSource noise(21);
  VectorXd lines = VectorXd::Zero(kSamples);
  for (int i = 3; i <= 20; ++i) lines += Sine(1e-8, 40.3 * i, i);
  std::vector<VectorXd> nominal{noise.Record() + lines};
  for (int i = 0; i < 9; ++i) nominal.push_back(noise.Record());
  const auto thresholds = DesignDisturbanceThresholds(nominal, kSampleTime, {});
  const auto report =
      AnalyseDisturbance(noise.Record() + lines, kSampleTime, thresholds, {});
  EXPECT_TRUE(report.tones.empty());
  EXPECT_FALSE(report.disturbed);
  const auto doubled =
      AnalyseDisturbance(noise.Record() + 2.0 * lines, kSampleTime, thresholds, {});
  EXPECT_EQ(doubled.tones.size(), 18U);
}

TEST(AnalyseDisturbance, TellsAnImpactFromNoiseAndTones) {
  NoiseSource noise(11);
  const auto thresholds = Design(noise);
  for (int i = 0; i < 20; ++i) {
    VectorXd residual = noise.Record();
    residual.segment(12000, 500) *= 30.0;
    const auto report = AnalyseDisturbance(residual, kSampleTime, thresholds, {});
    EXPECT_TRUE(report.tones.empty());
    EXPECT_FALSE(report.noise_raised) << report.noise_ratio;
    EXPECT_TRUE(report.disturbed);
  }
}

TEST(AnalyseDisturbance, FindsAToneThatSetsInWithinTheRecord) {
  NoiseSource noise(12);
  const auto thresholds = Design(noise);
  VectorXd tone = Sine(1e-6, 301.4);
  tone.head(9000).setZero();
  const auto report =
      AnalyseDisturbance(noise.Record() + tone, kSampleTime, thresholds, {});
  ASSERT_EQ(report.tones.size(), 1U);
  EXPECT_NEAR(report.tones[0].frequency, 301.4, 0.01);
}

TEST(AnalyseDisturbance, SeesNoiseThatRoseInAPartOfTheBand) {
  // A tenth of the bins, too few to move the median of all.
  NoiseSource noise(13);
  std::vector<VectorXd> nominal(5);
  for (VectorXd& run : nominal) run = noise.White();
  const auto thresholds = DesignDisturbanceThresholds(nominal, kSampleTime, {});
  VectorXd extra = noise.White(3.0 * kNoise);
  SectionFilter low(DigitalButterworth(FilterKind::kLowPass, 8, 400.0, kSampleTime));
  for (double& value : extra) value = low.Update(value);
  const auto report =
      AnalyseDisturbance(noise.White() + extra, kSampleTime, thresholds, {});
  EXPECT_TRUE(report.noise_raised);
  EXPECT_TRUE(report.tones.empty());
}

TEST(AnalyseDisturbance, MeasuresFrequencyAndAmplitudeWithinTheirErrors) {
  // 200 tones at random frequencies, 100 times the floor's line. Within 1.96 sd lie 95
  // % of them, 182 to 197 in 99 % of all cases.
  NoiseSource noise(14);
  const auto thresholds = Design(noise);
  int frequencies = 0;
  int amplitudes = 0;
  for (int i = 0; i < 200; ++i) {
    const double frequency = 150.0 + 500.0 * noise.Uniform();
    const VectorXd residual =
        noise.Record() + Sine(2e-8, frequency, kTwoPi * noise.Uniform());
    const auto report = AnalyseDisturbance(residual, kSampleTime, thresholds, {});
    ASSERT_EQ(report.tones.size(), 1U);
    const DisturbanceTone& tone = report.tones[0];
    EXPECT_LT(tone.frequency_sd, 0.01 * report.spectrum.resolution());
    frequencies += std::abs(tone.frequency - frequency) < 1.96 * tone.frequency_sd;
    amplitudes += std::abs(tone.amplitude - 2e-8) < 1.96 * tone.amplitude_sd;
  }
  EXPECT_GE(frequencies, 182);
  EXPECT_LE(frequencies, 197);
  EXPECT_GE(amplitudes, 182);
  EXPECT_LE(amplitudes, 197);
}

TEST(AnalyseDisturbance, RefusesWhatItCannotAnalyse) {
  NoiseSource noise(15);
  const std::vector<VectorXd> nominal{noise.Record()};
  const auto thresholds = DesignDisturbanceThresholds(nominal, kSampleTime, {});
  const VectorXd record = noise.Record();
  EXPECT_NO_THROW(AnalyseDisturbance(record.head(4096), kSampleTime, thresholds, {}));
  EXPECT_THROW(AnalyseDisturbance(record.head(4095), kSampleTime, thresholds, {}),
               InputError);
  EXPECT_THROW(AnalyseDisturbance(record, 2.0 * kSampleTime, thresholds, {}),
               InputError);
  EXPECT_THROW(AnalyseDisturbance(record, kSampleTime, {}, {}), InputError);
  VectorXd broken = record;
  broken[700] = std::nan("");
  EXPECT_THROW(AnalyseDisturbance(broken, kSampleTime, thresholds, {}), InputError);
}

TEST(DesignDisturbanceThresholds, RefusesWhatMakesNoThreshold) {
  NoiseSource noise(16);
  const auto design = [](std::vector<VectorXd> nominal,
                         const DisturbanceOptions& options) {
    return DesignDisturbanceThresholds(nominal, kSampleTime, options);
  };
  const VectorXd record = noise.Record();
  EXPECT_EQ(design({record, record.head(900)}, {}).segment, 900);
  EXPECT_NO_THROW(design({record.head(64)}, {}));
  EXPECT_THROW(design({record.head(63)}, {}), InputError);
  EXPECT_THROW(design({}, {}), InputError);
  EXPECT_THROW(design({VectorXd::Zero(kSamples)}, {}), InputError);
  EXPECT_THROW(design({record}, {.segment = 63}), InputError);
  EXPECT_THROW(design({record}, {.low = 100.0, .high = 120.0}), InputError);
  EXPECT_THROW(design({record}, {.low = 100.0, .high = 90.0}), InputError);
  EXPECT_THROW(design({record}, {.peak_margin = -0.1}), InputError);
  EXPECT_THROW(design({record}, {.tone_false_alarm = 0.0}), InputError);
}

}  // namespace
}  // namespace mjdiag
