#pragma once
// The frequency of a line to a small fraction of a spectrum's bin: where the
// periodogram of the whole record r_n under a Hann window w_n,
//   P(f) = |sum_n w_n r_n exp(-i 2 pi f T n)|^2,
// is highest. Noise of density B in quadrature to a sine of amplitude A turns its
// phase; with the time t_n from the record's middle, the frequency has the standard
// deviation
//   sqrt(B / T sum (w_n t_n)^2) / (2 pi A sum w_n t_n^2).

#include <Eigen/Core>

namespace mjdiag {

/// [Hz]
/// @param around   [Hz], at most a bin of a segment from the line
/// @param segment  samples of the segments in whose spectrum the line was found
double LineFrequency(const Eigen::VectorXd& residual, double sample_time, double around,
                     Eigen::Index segment);

/// Standard deviation [Hz] of that.
/// @param amplitude  A, of the sine
/// @param density    B, of the noise at the line
double LineFrequencySd(Eigen::Index samples, double sample_time, double amplitude,
                       double density);

}  // namespace mjdiag
