#pragma once
// How models compare: by what they leave,
//
//   deviance = sum over sensors of n_c (log s_c^2 + m_c / s_c^2),  s_c^2 = max(1, m_c)
//
// m_c: mean square of the scaled innovations, 1 if sensor noise is all that is left;
// n_c: number of independent values among them, fewer than samples if what is left is
// coloured.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// Deviance of samples first .. last - 1.
/// @param independent  n_c over the number of samples measured, of every sensor
/// @param measured     how many of them were, of every sensor; empty: all
double Deviance(const Eigen::VectorXd& residual, const Eigen::VectorXd& independent,
                Eigen::Index first, Eigen::Index last,
                const Eigen::VectorXd& measured = {});

/// n_c over the number of samples measured of every sensor, from the spectra of the
/// residual.
Eigen::VectorXd IndependentShare(const DiscoveryProblem& problem,
                                 const Eigen::VectorXd& residual);

/// By how much gains by chance are larger beside a fit than in white noise alone: what it
/// leaves may be more than sensor noise, and coloured.
/// @param train        mean square of what it leaves
/// @param independent  as IndependentShare
double Inflation(double train, const Eigen::VectorXd& independent);

/// Gain that the best of `trials` reaches by chance with that probability where there
/// is noise only, of a trial with that many degrees of freedom: chi-squared.
double GainByChance(double probability, int trials, int freedom);

/// Mean square of the innovations over sensor noise from which something is left,
/// whatever a screening says.
inline constexpr double kFarAboveNoise = 4.0;

/// Whether that cause of the fit may be one: its shape is not at its end, and where the fit
/// leaves far more than noise its sizes are plausible.
bool IsCredible(const std::vector<Candidate>& candidates, const CauseFit& fit,
                const FittedCause& cause);

/// Bayesian information criterion of samples first .. last - 1 with what is known
/// beforehand, deviance + PriorOf + parameters log n. The numbers of the plant are the same
/// in all sets that compare.
/// @param independent, measured  as Deviance
double Criterion(const CauseFit& fit, const Eigen::VectorXd& independent,
                 Eigen::Index first, Eigen::Index last,
                 const Eigen::VectorXd& measured = {});

/// Criteria of competing fits on the train part. How many independent values they are
/// judged by is what the best of them leaves: beside all models a real machine does what
/// is no white noise, and a law with many parameters must not win by that. A fit that
/// failed, and is none, has infinity.
std::vector<double> Criteria(const DiscoveryProblem& problem,
                             const std::vector<std::optional<CauseFit>>& fits);

}  // namespace mjdiag
