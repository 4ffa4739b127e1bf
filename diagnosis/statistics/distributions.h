#pragma once
// The probability distributions behind thresholds, intervals and tests (Boost.Math; its
// headers are read by distributions.cc only).
//
// A quantile here is the upper one: the x that the variable exceeds with the given
// probability. That of a rare exceedance is so as accurate as any other, which 1 minus
// a probability would not be.
//
// Relative errors are below 1e-12, that of a quantile for probabilities from 1e-300 on.
// Outside the ranges named, and for NaN, the result is NaN; the quantile of a
// probability of 0 is infinite.

#include <Eigen/Core>
#include <utility>

namespace mjdiag {

/// Density of the normal distribution at every x. @param sd  > 0
Eigen::VectorXd NormalDensity(const Eigen::VectorXd& x, double mean, double sd);

/// Of the standard normal distribution. @param probability  0 to 1
double NormalQuantile(double probability);

/// k with P(|X| > k) = probability, X standard normal. @param probability  0 to 1
double TwoSidedNormalQuantile(double probability);

/// Of Student's t, the ratio of a standard normal variable to an estimate of its
/// standard deviation. @param probability  0 to 1  @param dof  > 0
double StudentQuantile(double probability, double dof);

/// P(t > x), Student's t. @param dof  > 0
double StudentExceedance(double x, double dof);

/// Of chi-squared, the sum of the squares of `dof` standard normal variables.
/// @param probability  0 to 1
/// @param dof          > 0
double ChiSquaredQuantile(double probability, double dof);

/// P(chi-squared > x). @param x  0 or more  @param dof  > 0
double ChiSquaredExceedance(double x, double dof);

/// The squared means, added up, of `dof` normal variables of variance 1 of which the sum of
/// squares, a noncentral chi-squared variable, exceeds x with that probability; 0 where it
/// does so without them.
/// @param x  0 or more  @param dof  > 0  @param probability  above 0, below 1
double NoncentralityOf(double x, double dof, double probability);

/// Of Fisher's F: the ratio of two estimates of the same variance or density, each as a
/// chi-squared variable divided by its degrees of freedom.
/// @param probability  0 to 1
/// @param dof1, dof2   degrees of freedom of numerator and denominator, > 0
double FQuantile(double probability, double dof1, double dof2);

/// P(F > x). @param x  0 or more  @param dof1, dof2  > 0
double FExceedance(double x, double dof1, double dof2);

/// The counts out of `trials` between which a binomial variable lies with at least this
/// confidence: the smallest ones that it stays below or at with a probability of
/// (1 - confidence) / 2 and (1 + confidence) / 2.
/// @param trials                  1 or more
/// @param probability, confidence  above 0, below 1
std::pair<int, int> BinomialInterval(int trials, double probability, double confidence);

/// The probabilities of which so many successes are no surprise: an interval that holds
/// the true one with at least this confidence (C. J. Clopper, E. S. Pearson, Biometrika
/// 26, 1934).
/// @param trials      1 or more
/// @param successes   0 to trials
/// @param confidence  above 0, below 1
std::pair<double, double> ProbabilityInterval(int trials, int successes,
                                              double confidence);

}  // namespace mjdiag
