#pragma once
// The search for causes: forwards, one cause at a time, then backwards.
//
// A round screens all candidates on what is left (screening.h), fits the best of them
// together with what has been found, first on the beginning of the record, then, those
// that are still in the race, on all of the train part (cause_fit.h), and keeps the one
// that is best. Models are compared by what they leave,
//
//   deviance = sum over sensors of n_c (log s_c^2 + m_c / s_c^2),  s_c^2 = max(1, m_c)
//
// m_c: mean square of the scaled innovations, 1 if sensor noise is all that is left;
// n_c: number of independent values among them, fewer than samples if what is left is
// coloured. A cause is kept if it lowers deviance + parameters log n (the Bayesian
// information criterion) on the train part and the deviance on the part held out and
// on another record, if there is one; else the next best is asked.
// Causes that a later one has made superfluous are dropped again. Probabilities of
// competing causes are exp(-BIC / 2) over their sum.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/candidate.h"
#include "mjdiag/discovery/cause_fit.h"
#include "mjdiag/discovery/problem.h"
#include "mjdiag/discovery/screening.h"

namespace mjdiag {

struct SearchOptions {
  int most_causes = 6;
  int shortlist = 8;  ///< candidates a round that are fitted
  /// Another record of the machine: what makes its innovations larger is no cause. Not
  /// owned, may be null.
  const MeasuredRun* unseen = nullptr;
  /// Chance to claim a cause where there is noise only, per round.
  double false_alarm = 1e-4;
  std::function<void(const std::string& what, double fraction)> progress;
};

/// A candidate that was in the race for a place.
struct Contender {
  FittedCause cause;
  double criterion = 0.0;  ///< BIC with it in place
  double probability = 0.0;
};

/// One round.
struct Rung {
  std::vector<Contender> contenders;  ///< best first
  CauseFit fit;                       ///< with the one that was kept
};

struct SearchResult {
  CauseFit fit;  ///< of all causes that are kept
  /// Of every cause of the fit, who else could have been in its place, itself included.
  std::vector<std::vector<Contender>> contenders;
  std::vector<Rung> ladder;
  /// Those that explained the train part best but not what a fit did not see.
  std::vector<FittedCause> refuted;
  Screening left;  ///< screening of what is left in the end
  /// Whether that shows any candidate to be significant.
  bool significant_rest = false;
};

/// Deviance of samples first .. last - 1.
/// @param independent  n_c over the number of samples, of every sensor
double Deviance(const Eigen::VectorXd& residual, const Eigen::VectorXd& independent,
                Eigen::Index first, Eigen::Index last);

/// n_c over the number of samples of every sensor, from the spectra of the residual.
Eigen::VectorXd IndependentShare(const DiscoveryProblem& problem,
                                 const Eigen::VectorXd& residual);

/// Gain that the best of `trials` reaches by chance with that probability where there
/// is noise only, of a trial with that many degrees of freedom.
double GainByChance(double probability, int trials, int freedom);

/// @param before  a search of the same record with another observer to go on from, or
///                null
SearchResult SearchCauses(const DiscoveryProblem& problem,
                          const std::vector<Candidate>& candidates,
                          const SearchOptions& options,
                          const SearchResult* before = nullptr);

}  // namespace mjdiag
