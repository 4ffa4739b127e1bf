#pragma once
// Intervals of fitted parameters that hold where the fit is far from linear: a velocity
// or a length in a law that is hardly larger than noise has a skew, long-tailed
// likelihood, which value and standard deviation do not describe.
//
// The profile of parameter i is P(x) = min over all others of S(theta | theta_i = x)
// - S(best), S the sum of squared innovations of the train part over their variance.
// The 95 % interval is where
//
//   P(x) <= chi2 s,    chi2 = 3.841 (one degree of freedom),   s = V_ii / C_ii
//
// with V the covariance that knows the colour of the innovations (ParameterCovariance)
// and C = (J^T J)^-1 the one of white ones; s = 1 for noise. (S. A. Murphy, A. W. van
// der Vaart, On Profile Likelihood, J. Am. Stat. Assoc. 95, 2000.)

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/statistics/interval.h"
#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// The 95 % intervals of all parameters of the fit: value +- 1.96 sd where the
/// likelihood is quadratic, for sizes of laws and where the standard deviation is small
/// beside the value; else the profile is followed from there to where it crosses. An
/// end beyond a parameter's bounds is the bound. Profiles are followed as far as the
/// work that is left allows.
/// @param fit         with the Jacobian at its solution
/// @param covariance  of its parameters
std::vector<Interval> ParameterIntervals(const DiscoveryProblem& problem,
                                         const std::vector<Candidate>& candidates,
                                         const CauseFit& fit,
                                         const Eigen::MatrixXd& covariance);

}  // namespace mjdiag
