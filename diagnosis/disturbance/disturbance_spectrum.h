#pragma once
// Which tones are in the disturbance residual, how strong is the disturbance behind
// them, and has the broadband noise risen ([AB383], Eq. 27 to 30)? The residual has
// passed R_dist and the high-pass filter (Eq. 33, 34); its power spectral density R(f)
// (Eq. 28) is compared with those R_i(f) of N nominal runs, i = 1 .. N.
//
// Thresholds. The margins of [AB383] are additive; ours are relative, beta = margin * max:
//   peak  = (1 + peak_margin)  max_i max_f R_i(f)                  (Eq. 29)
//   total = (1 + total_margin) max_i sum_f R_i(f) df               (Eq. 30)
//
// Eq. 29 alone cannot tell a tone from noise: tenfold noise lifts every R(f)
// hundredfold. And where the nominal density is low it hides what stands out clearly.
// So a tone is a bin that stands out of the noise around it. With S(f) the mean of the
// R_i(f), the whitened ratio R / S is level wherever noise has the nominal shape, and
//   B(f) = S(f) * median over neighbouring bins of R / S   (bias of the median removed)
// is the noise density expected in this record (residual_noise.h). R / B follows an F
// distribution, and the threshold at each frequency (tone_search.h) is
//   sqrt(threshold) = leak + sqrt(max(F B, F side, (1 + peak_margin) highest))
//   highest = max_i R_i(f -+ df)
// where F is the F distribution's quantile at tone_false_alarm / number of bins; `side`
// is the higher of the medians of R left and right of the bin, so that broadband power
// of a shape unlike S, such as of an impact, makes no tones on the slopes of S; the
// third term keeps periodic lines that some nominal runs have by themselves from being
// tones; and `leak` is what a Hann window leaks from the stronger tones already found:
// amplitudes add at most (triangle inequality), so leakage never makes a tone. Tones
// closer than three bins are one.
//
// Noise has risen if the median of R / S over all bins, or the broadband power (the
// sum of S df times that median, block by block of bins: noise that has risen in part
// of the band), exceeds that of all nominal runs by total_margin. Both are taken from
// the record without its tones, segment by segment, and of the segments the median:
// what passes in less than half of them (an impact, a tone that sets in) is not raised
// noise. It may still take the total over its threshold.
//
// Limits. Tones of an amplitude that varies have side bands of their own. Lines of a
// comb need ten bins between them, or they pass for noise.

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "mjdiag/signals/spectrum.h"

namespace mjdiag {

struct DisturbanceOptions {
  /// Samples a Welch segment, at least 64; shortened to the shortest nominal run.
  Eigen::Index segment = 4096;
  double low = 0.0;  ///< [Hz] of the band in which tones and power are looked for
  double high = std::numeric_limits<double>::infinity();  ///< [Hz]
  double peak_margin = 1.0;    ///< beta_peak relative to the maximum, >= 0
  double total_margin = 0.25;  ///< beta_total relative to the maximum, >= 0
  /// Upper bound on the probability that a nominal record shows any tone, 0 to 1.
  double tone_false_alarm = 1e-4;
};

/// [unit] is the residual's.
struct DisturbanceThresholds {
  Eigen::Index segment = 0;  ///< samples a Welch segment
  double peak = 0.0;         ///< R_peak [unit^2/Hz], Eq. 29
  double total = 0.0;        ///< R_total [unit^2], Eq. 30
  double noise_ratio = 1.0;  ///< above it the broadband noise has risen, or
  double broadband = 0.0;    ///< above this power of the noise without tones [unit^2]
  Spectrum nominal;          ///< S(f), mean of the nominal runs
  Eigen::VectorXd highest;   ///< max_i R_i(f) [unit^2/Hz]
  double nominal_dof = 0.0;  ///< degrees of freedom of S
};

struct DisturbanceTone {
  double frequency = 0.0;     ///< [Hz], from the whole record, not a bin's
  double frequency_sd = 0.0;  ///< [Hz], what the noise contributes
  double psd = 0.0;           ///< R at its bin [unit^2/Hz]
  double threshold = 0.0;     ///< the one that applied there [unit^2/Hz]
  double amplitude = 0.0;     ///< of the sine in the residual [unit]
  double amplitude_sd = 0.0;  ///< [unit]
  bool above_peak = false;    ///< psd > R_peak: Eq. 29 sees it, too
};

struct DisturbanceReport {
  Spectrum spectrum;                   ///< R(f)
  Spectrum floor;                      ///< B(f), the noise without the tones
  std::vector<DisturbanceTone> tones;  ///< in order of frequency
  double total = 0.0;                  ///< sum of R df over the band [unit^2]
  double total_threshold = 0.0;        ///< R_total [unit^2]
  double broadband = 0.0;              ///< power of the noise, without tones [unit^2]
  double noise_ratio = 1.0;  ///< broadband density relative to nominal; 1: nominal
  bool noise_raised = false;
  bool disturbed = false;  ///< a tone, raised noise or total > total_threshold
};

/// @param nominal      residuals of nominal runs, all at the same rate
/// @param sample_time  [s], > 0
/// InputError on options out of range, no run, runs that are too short, not finite or
/// zero, and a band of fewer than 16 bins.
DisturbanceThresholds DesignDisturbanceThresholds(
    std::span<const Eigen::VectorXd> nominal, double sample_time,
    const DisturbanceOptions& options);

/// @param residual  at the same rate as the nominal runs, at least a segment long
/// @param options   band, margins and false-alarm probability as in the design
/// InputError if the record is too short, not finite or sampled at another rate.
DisturbanceReport AnalyseDisturbance(const Eigen::VectorXd& residual,
                                     double sample_time,
                                     const DisturbanceThresholds& thresholds,
                                     const DisturbanceOptions& options);

}  // namespace mjdiag
