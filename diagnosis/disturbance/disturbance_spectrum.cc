#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "mjdiag/diagnosis/disturbance/line_frequency.h"
#include "mjdiag/diagnosis/disturbance/residual_noise.h"
#include "mjdiag/diagnosis/disturbance/residual_record.h"
#include "mjdiag/diagnosis/disturbance/sine_fit.h"
#include "mjdiag/diagnosis/disturbance/tone_search.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/median.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kPasses = 4;  // in search of lines that stronger ones hide

/// The median, of an even number of values the mean of both in the middle.
double Middle(const VectorXd& values) {
  return 0.5 * (Median(values) - Median(-values));
}

VectorXd LineFrequencies(const std::vector<SpectralLine>& lines,
                         const VectorXd& residual, double sample_time, Index segment) {
  const double bin = 1.0 / (static_cast<double>(segment) * sample_time);
  VectorXd frequency(static_cast<Index>(lines.size()));
  for (Index j = 0; j < frequency.size(); ++j) {
    const auto around = static_cast<double>(lines[static_cast<std::size_t>(j)].bin);
    frequency[j] = LineFrequency(residual, sample_time, around * bin, segment);
  }
  return frequency;
}

std::vector<DisturbanceTone> MakeTones(const std::vector<SpectralLine>& lines,
                                       const VectorXd& frequency,
                                       const VectorXd& coefficients,
                                       const Spectrum& floor, Index samples,
                                       double sample_time, double peak) {
  std::vector<DisturbanceTone> tones;
  const double variance = FitVariance(samples, sample_time);
  for (Index j = 0; j < frequency.size(); ++j) {
    const SpectralLine& line = lines[static_cast<std::size_t>(j)];
    const double density = DensityAt(floor, frequency[j]);
    DisturbanceTone tone;
    tone.frequency = frequency[j];
    tone.psd = line.psd;
    tone.threshold = line.threshold;
    tone.amplitude = coefficients.segment(2 * j, 2).norm();
    tone.amplitude_sd = std::sqrt(density * variance);
    tone.frequency_sd = LineFrequencySd(samples, sample_time, tone.amplitude, density);
    tone.above_peak = line.psd > peak;
    tones.push_back(tone);
  }
  std::sort(tones.begin(), tones.end(),
            [](const DisturbanceTone& a, const DisturbanceTone& b) {
              return a.frequency < b.frequency;
            });
  return tones;
}

void RequireOptions(const DisturbanceOptions& options) {
  const auto require = [](bool good, const char* what, const char* expected) {
    if (!good) throw InputError("disturbance options", what, expected);
  };
  require(options.segment >= kMinSegment, "segment too short", "at least 64 samples");
  require(options.low >= 0.0 && options.high > options.low, "an empty band",
          "0 <= low < high");
  require(options.peak_margin >= 0.0 && options.total_margin >= 0.0,
          "a negative margin", "0 or more");
  require(options.tone_false_alarm > 0.0 && options.tone_false_alarm < 1.0,
          "a false-alarm probability out of range", "between 0 and 1");
}

void RequireRate(const DisturbanceThresholds& thresholds, double sample_time) {
  if (thresholds.segment < kMinSegment ||
      thresholds.nominal.density.size() != thresholds.segment / 2 + 1 ||
      thresholds.highest.size() != thresholds.nominal.density.size()) {
    throw InputError("disturbance thresholds", "spectra that do not fit the segment",
                     "those of DesignDisturbanceThresholds");
  }
  const double rate =
      thresholds.nominal.resolution() * static_cast<double>(thresholds.segment);
  if (std::abs(rate * sample_time - 1.0) > 1e-6) {
    throw InputError("disturbance residual",
                     "sampled at " + std::to_string(1.0 / sample_time) + " Hz",
                     "the " + std::to_string(rate) + " Hz of the nominal runs");
  }
}

}  // namespace

DisturbanceThresholds DesignDisturbanceThresholds(std::span<const VectorXd> nominal,
                                                  double sample_time,
                                                  const DisturbanceOptions& options) {
  RequireOptions(options);
  if (nominal.empty()) {
    throw InputError("disturbance thresholds", "no nominal run", "at least one");
  }
  DisturbanceThresholds thresholds;
  thresholds.segment = options.segment;
  for (const VectorXd& run : nominal) {
    RequireRecord(run, sample_time, kMinSegment);
    thresholds.segment = std::min(thresholds.segment, run.size());
  }
  std::vector<Spectrum> spectra;
  double variance = 0.0;
  for (const VectorXd& run : nominal) {
    spectra.push_back(WelchDensity(run, sample_time, thresholds.segment));
    variance += 1.0 / WelchDof(WelchSegments(run.size(), thresholds.segment));
  }
  const auto runs = static_cast<double>(nominal.size());
  thresholds.nominal_dof = runs * runs / variance;
  thresholds.nominal = spectra.front();
  thresholds.nominal.density.setZero();
  thresholds.highest = thresholds.nominal.density;
  for (const Spectrum& spectrum : spectra) {
    thresholds.nominal.density += spectrum.density / runs;
    thresholds.highest = thresholds.highest.cwiseMax(spectrum.density);
  }
  const BinRange bins = UsableBins(thresholds.nominal, options);
  if (!(thresholds.nominal.density.segment(bins.first, bins.count).maxCoeff() > 0.0)) {
    throw InputError("disturbance thresholds", "nominal residuals that are zero",
                     "residuals with their measurement noise");
  }
  thresholds.peak = (1.0 + options.peak_margin) *
                    thresholds.highest.segment(bins.first, bins.count).maxCoeff();
  for (std::size_t i = 0; i < spectra.size(); ++i) {
    thresholds.total =
        std::max(thresholds.total, BandPower(spectra[i], options.low, options.high));
    const SegmentNoise noise =
        NoiseOfSegments(nominal[i], sample_time, thresholds, bins, {});
    thresholds.noise_ratio = std::max(thresholds.noise_ratio, Middle(noise.level));
    thresholds.broadband = std::max(thresholds.broadband, Middle(noise.power));
  }
  thresholds.total *= 1.0 + options.total_margin;
  thresholds.noise_ratio *= 1.0 + options.total_margin;
  thresholds.broadband *= 1.0 + options.total_margin;
  return thresholds;
}

DisturbanceReport AnalyseDisturbance(const VectorXd& residual, double sample_time,
                                     const DisturbanceThresholds& thresholds,
                                     const DisturbanceOptions& options) {
  RequireOptions(options);
  RequireRecord(residual, sample_time, thresholds.segment);
  RequireRate(thresholds, sample_time);
  const BinRange bins = UsableBins(thresholds.nominal, options);
  const double dof =
      RecordDof(NoiseOfSegments(residual, sample_time, thresholds, bins, {}).level);

  DisturbanceReport report;
  report.spectrum = WelchDensity(residual, sample_time, thresholds.segment);
  report.total = BandPower(report.spectrum, options.low, options.high);
  report.total_threshold = thresholds.total;

  // The skirts of strong tones hide weak ones and would pass for noise: look again
  // after taking them out.
  std::vector<SpectralLine> lines;
  VectorXd frequency;
  VectorXd coefficients;
  Spectrum rest_spectrum = report.spectrum;
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::size_t known = lines.size();
    AddLines(report.spectrum, rest_spectrum, thresholds, options, bins, dof, lines);
    if (lines.size() == known) break;
    frequency = LineFrequencies(lines, residual, sample_time, thresholds.segment);
    coefficients = FitSines(residual, sample_time, 0.0, frequency);
    rest_spectrum =
        WelchDensity(WithoutSines(residual, sample_time, frequency, coefficients),
                     sample_time, thresholds.segment);
  }
  const SegmentNoise noise =
      NoiseOfSegments(residual, sample_time, thresholds, bins, frequency);
  report.floor = ExpectedNoise(rest_spectrum, thresholds, bins, dof);
  report.noise_ratio = Middle(noise.level);
  report.broadband = Middle(noise.power);
  report.tones = MakeTones(lines, frequency, coefficients, report.floor,
                           residual.size(), sample_time, thresholds.peak);
  report.noise_raised = report.noise_ratio > thresholds.noise_ratio ||
                        report.broadband > thresholds.broadband;
  report.disturbed = !report.tones.empty() || report.noise_raised ||
                     report.total > report.total_threshold;
  return report;
}

}  // namespace mjdiag
