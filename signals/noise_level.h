#pragma once
// How noisy is a measured signal? The standard deviation of white noise e on a smooth
// signal s, from x = s + e alone, without a model or a filter.
//
// Differences of order m nearly cancel a signal that is smooth over m samples, while
// those of white noise grow: with (D x)[k] = x[k+1] - x[k],
//   sd(D^m e) = sigma sqrt(binomial(2 m, m))
//   |D^m s| <= A (2 sin(pi f T))^m   for a sine of amplitude A and frequency f
// The scale of D^m x is taken by its median absolute value, which shrugs off impacts,
// steps and other short events that are not smooth:
//   sigma = median |D^m x| / (0.67449 sqrt(binomial(2 m, m)))
//
// Valid for signal content well below a sixth of the sampling rate (where differences
// neither shrink nor grow it) and Gaussian noise that is white up to half the sampling
// rate. It is then unbiased, with a relative standard deviation of about
// 1.3 sqrt(m / samples) or less.
//
// Quantisation adds step / sqrt(12) to it (in squares) if the noise is at least a step.
// Without that the error of quantising a smooth signal is not white and the result is
// only its order of magnitude; a signal that rests most of the time gives 0.

#include <Eigen/Core>

namespace mjdiag {

/// @param signal  [unit], more than `order` + 2 samples
/// @param order   m, 1 to 12
/// @return sigma [unit]
/// InputError on values out of range.
double NoiseLevel(const Eigen::VectorXd& signal, int order = 6);

}  // namespace mjdiag
