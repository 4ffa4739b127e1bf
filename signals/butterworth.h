#pragma once
// Butterworth low-pass and high-pass filters: maximally flat gain
//   |H(f)|^2 = 1 / (1 + (f / fc)^(2 n))   (low-pass; high-pass with fc / f)
// Half power at the cut-off frequency fc for every order n.

#include <Eigen/Core>

#include "mjdiag/signals/second_order_sections.h"

namespace mjdiag {

enum class FilterKind { kLowPass, kHighPass };

/// H(s) = numerator(s) / denominator(s), coefficients in descending powers of s.
struct TransferFunction {
  Eigen::VectorXd numerator;
  Eigen::VectorXd denominator;
};

/// The continuous filter, monic, as Eq. 31 (low-pass, n = 7, fc = 50 Hz), Eq. 33 (its
/// denominator, n = 7, fc = 750 Hz) and Eq. 34 (high-pass, n = 3, fc = 100 Hz) of
/// [AB383] have it. With wc = 2 pi fc the denominator is
///   sum_k a_k wc^k s^(n-k),  a_0 = 1,
///   a_k = a_(k-1) cos((k-1) pi / (2 n)) / sin(k pi / (2 n))
/// and the numerator wc^n (low-pass) or s^n (high-pass).
/// @param order    n, 1 to 20
/// @param cutoff   fc [Hz], > 0
/// @return both polynomials with n + 1 coefficients
/// InputError on values out of range.
TransferFunction ContinuousButterworth(FilterKind kind, int order, double cutoff);

/// The digital filter by the bilinear transform with prewarping, so that the half-power
/// frequency is exactly fc. A section for each pair of poles, and one of first order
/// before them if n is odd; each has gain 1 in the pass band.
/// @param order        n, 1 to 20
/// @param cutoff       fc [Hz], between 0 and half the sampling rate
/// @param sample_time  [s], > 0
/// InputError on values out of range.
SecondOrderSections DigitalButterworth(FilterKind kind, int order, double cutoff,
                                       double sample_time);

}  // namespace mjdiag
