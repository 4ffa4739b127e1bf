#pragma once
// Whether the causes that were named can be all that the list of laws lacks: then what
// they leave is the noise of the sensors, and its colour is known. A law that is in no list
// leaves more, however well the nearest one in the list fits.
//
//   Q = n sum over l = 1 .. m of (r_l - rho_l)^2,   chi-squared with m degrees of freedom
//
// r_l is the autocorrelation of the innovations of a sensor, rho_l what noise alone makes
// of it behind the observer [Box 1970]. What no fit saw is as large as what the
// fit left, by the F-distribution. The smallest p of these many (Bonferroni) makes the
// Bayes factor of noise against anything at most
//
//   B = -e p ln p,   p < 1/e, else 1                    [Sellke 2001]
//
// and with it P = B / (B + (1 - P_0) / P_0) is the probability that nothing is missing.

#include <Eigen/Core>

#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// The p of the innovations. 1 where no sensor can tell: quantisation, which is coloured,
/// may be all that is left.
/// @param innovations  scaled, all samples
/// @param unseen       of another record; may be empty
/// @param measured     which of those were measured, ny x samples; empty: all
double NoiseValue(const DiscoveryProblem& problem, const Eigen::VectorXd& innovations,
                  const Eigen::VectorXd& unseen,
                  const Eigen::ArrayXX<bool>& measured = {});

/// P, of a p.
double ProbabilityOfNoise(double p);

/// Whether nothing is missing rather than something.
bool IsComplete(double complete);

/// How probable it is that a cause is the one that was named, not one that is in no list.
/// @param named     its probability among the laws of the list
/// @param complete  ProbabilityOfNoise of what is left
double AmongAllLaws(double named, double complete);

}  // namespace mjdiag
