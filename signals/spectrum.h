#pragma once
// Power spectral densities of recorded signals ([AB383], Eq. 28), by Welch's method:
// the mean of the periodograms of overlapping segments, each freed of its mean and
// weighted by a Hann window. One-sided: the power of negative frequencies is added to
// that of the positive ones, so that
//   sum_k S(f_k) df = mean square of the signal about its mean  (in expectation).
//
// With window w_n = sin^2(pi n / L), segment length L and X the transform of w x,
//   S(f_k) = c_k T |X_k|^2 / sum_n w_n^2,   f_k = k / (L T),   k = 0 .. L / 2
// and c_k = 2 except c_0 = 1 and c_(L/2) = 1 (L even).

#include <Eigen/Core>
#include <vector>

namespace mjdiag {

/// A one-sided power spectral density of a signal in [unit].
struct Spectrum {
  Eigen::VectorXd frequency;  ///< [Hz], 0, df, 2 df, ...
  Eigen::VectorXd density;    ///< [unit^2/Hz]

  /// df [Hz]
  double resolution() const { return frequency.size() < 2 ? 0.0 : frequency[1]; }
};

/// Welch's estimate.
/// @param signal       [unit], at least `segment` samples
/// @param sample_time  T [s], > 0
/// @param segment      L, at least 2: df = 1 / (L T)
/// @param overlap      samples that neighbouring segments share, 0 to L - 1; samples at
///                     the end that do not fill a segment are left out
/// InputError on values out of range.
Spectrum WelchDensity(const Eigen::VectorXd& signal, double sample_time,
                      Eigen::Index segment, Eigen::Index overlap);

/// The same with half overlap, at which a Hann window loses the least.
Spectrum WelchDensity(const Eigen::VectorXd& signal, double sample_time,
                      Eigen::Index segment);

/// The power between two frequencies, sum of S(f_k) df over low <= f_k <= high: the
/// integral of [AB383], Eq. 30. [unit^2]
double BandPower(const Spectrum& spectrum, double low, double high);

struct SpectralPeak {
  double frequency = 0.0;  ///< [Hz]
  double density = 0.0;    ///< [unit^2/Hz]
};

/// Local maxima above the threshold (R(f) > R_peak, [AB383], Eq. 29), in order of
/// frequency. A maximum that extends over equal neighbours counts once, at its start.
std::vector<SpectralPeak> FindPeaks(const Spectrum& spectrum, double threshold);

}  // namespace mjdiag
