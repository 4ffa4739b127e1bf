#pragma once
// Sines of known frequencies in a record r(t) of T seconds a sample,
//   r(t) = sum_j (a_j sin(2 pi f_j t) + b_j cos(2 pi f_j t)) + noise,
// by least squares of all of them at once under a Tukey window w (a tenth of the record
// tapered at each end). It keeps strong noise at other frequencies out and costs 4 % of
// the standard deviation. In noise of the one-sided density B(f)
//   var a_j = var b_j = B(f_j) sum w^2 / (T (sum w)^2).

#include <Eigen/Core>

#include "mjdiag/signals/spectrum.h"

namespace mjdiag {

/// The coefficients [a_1 b_1 a_2 b_2 ...], in the record's unit.
/// @param start_time  t of the first sample [s]
/// @param frequency   f_j [Hz], at least a resolution of the record from each other
Eigen::VectorXd FitSines(const Eigen::VectorXd& residual, double sample_time,
                         double start_time, const Eigen::VectorXd& frequency);

/// The variance of a coefficient for a unit of noise density. [1/s]
double FitVariance(Eigen::Index samples, double sample_time);

/// The noise density at a frequency, linear between bins.
double DensityAt(const Spectrum& spectrum, double frequency);

/// The record without sines fitted from start time 0.
Eigen::VectorXd WithoutSines(Eigen::VectorXd residual, double sample_time,
                             const Eigen::VectorXd& frequency,
                             const Eigen::VectorXd& coefficients);

}  // namespace mjdiag
