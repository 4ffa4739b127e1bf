#pragma once
// The magnitude gamma of a disturbance gamma * sum_j sin(2 pi f_j t) from the residual
//   r(t) = sum_j Im(a_j exp(i 2 pi f_j t)) + noise,   a_j = gamma g_j
// by a fit of the sines and cosines (sine_fit.h). Each part of a_j has the variance
// v_j = B(f_j) sum w^2 / (T (sum w)^2), w the fit's window, and
//   gamma = sum_j Re(conj(g_j) a_j) / v_j / sum_j |g_j|^2 / v_j,
//   sd = (sum_j |g_j|^2 / v_j)^(-1/2).
// With unknown phases gamma >= 0 is the maximum of the likelihood of |a_j| (Rice
// distribution) and sd holds for gamma well above it.

#include <Eigen/Core>

#include "mjdiag/signals/spectrum.h"

namespace mjdiag {

/// Is the phase of each sine known from the gain, or any?
enum class TonePhase { kKnown, kUnknown };

struct MagnitudeEstimate {
  double value = 0.0;
  double sd = 0.0;
};

/// gamma, and the standard deviation that the noise gives it.
/// @param frequency    f_j [Hz], at least 2 / record length from 0, from half the
///                     sampling rate and from each other
/// @param gain         g_j, residual per unit of gamma
/// @param noise        one-sided noise density B, such as DisturbanceReport::floor
/// @param start_time   t of the first sample [s]
/// InputError on values out of range.
MagnitudeEstimate ToneMagnitude(const Eigen::VectorXd& residual, double sample_time,
                                const Eigen::VectorXd& frequency,
                                const Eigen::VectorXcd& gain, const Spectrum& noise,
                                TonePhase phase = TonePhase::kKnown,
                                double start_time = 0.0);

}  // namespace mjdiag
