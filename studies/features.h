#pragma once
// Time and frequency features of a record's signals: what a data-driven method sees of
// a run in place of its samples (the method that [AB383], Table 4 compares with).
//
// Of a signal x_k, k = 0 .. N-1, with mean m, standard deviation s (about m, over N),
// r = rms x, p = max |x|, a = mean |x|:
//
//   mean m             log_rms log10 r        log_sd log10 s      log_peak log10 p
//   crest p / r        kurtosis mean ((x - m) / s)^4              shape_factor r / a
//   impulse_factor p / a                      skewness mean ((x - m) / s)^3
//   log_peak_to_peak log10 (max x - min x)
//
// and of its Welch density S(f_i) (signals/spectrum.h), with P = sum_i S(f_i):
//
//   log_power_<low>-<high>_Hz  log10 of the power in a band, sum S df over
//                              low < f_i <= high. The bands are octaves down from the
//                              Nyquist frequency; the lowest one reaches to 0
//   centroid  c = sum_i f_i S(f_i) / P  [Hz]
//   spread    sqrt(sum_i (f_i - c)^2 S(f_i) / P)  [Hz]
//   dominant  the f_i at which S is largest  [Hz]
//
// Another unit of x maps each feature by an affine function, which standardisation
// takes out again. Every feature of a finite signal is finite: a logarithm sees at
// least 1e-13 of the peak, and of that at least 1e-30, a signal that does not vary by
// more has skewness 0, kurtosis 3 and 0 Hz, a signal that is zero has ratios 1.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/signals/record.h"

namespace mjdiag {

struct FeatureOptions {
  Eigen::Index segment = 2048;  ///< samples of a Welch segment, half overlapping
  int bands = 9;                ///< octave bands, 1 to log2(segment)
  /// For every channel c of which the record has a reference "c_ref", also the features
  /// of "c_error" = c_ref - c.
  bool tracking_errors = true;
};

/// The features of the channels, in their order, each followed by its tracking error.
/// InputError if there are no channels, the record lacks one or holds a value that is
/// not finite, is shorter than a segment, or an option is out of range.
Eigen::VectorXd Features(const Record& record, const std::vector<std::string>& channels,
                         const FeatureOptions& options = {});

/// What Features returns, entry by entry: "x.log_rms", "x_error.centroid". The samples
/// of the record are not looked at. The same InputErrors for channels and options.
std::vector<std::string> FeatureNames(const Record& record,
                                      const std::vector<std::string>& channels,
                                      const FeatureOptions& options = {});

}  // namespace mjdiag
