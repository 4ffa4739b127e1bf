#pragma once
// The search for causes: forwards, one cause at a time, then backwards.
//
// A round screens all candidates on what is left (screening.h), fits the best of them
// together with what has been found, first on the beginning of the record, then, those
// that are still in the race, on all of the train part (cause_fit.h). They compete for
// the place by the Bayesian information criterion, deviance + parameters log n
// (model_choice.h), on the train part. The best is kept if it lowers that, and does not
// raise the deviance on the part held out and on another record, if there is one; else
// the next is asked.
//
// Causes that a later one has made superfluous are dropped again, and exchanged where
// with all others known another one is better (refinement.h).

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/screening/screening.h"
#include "mjdiag/discovery/selection/contender.h"
#include "mjdiag/discovery/selection/refinement.h"

namespace mjdiag {

struct SearchOptions {
  int most_causes = 6;
  int shortlist = 8;  ///< candidates a round that are fitted
  /// Another record of the machine: what makes its innovations larger is no cause. Not
  /// owned, may be null.
  const MeasuredRun* unseen = nullptr;
  /// Chance to claim a cause where there is noise only, per round.
  double false_alarm = 1e-4;
  /// Whether another search goes on from such a fit: then no causes are exchanged, and
  /// the fit is left as it is. May be empty: none does.
  std::function<bool(const CauseFit& fit)> preliminary;
  /// Whether the problem still serves beside such a fit: a search ends where it does
  /// not, with what it has found up to there. May be empty: it does.
  std::function<bool(const CauseFit& fit)> serves;
  /// Whether to fit the causes once more in the end, as closely as possible.
  bool last_fit = true;
  std::function<void(const std::string& what, double fraction)> progress;
};

/// One round.
struct Rung {
  std::vector<Contender> contenders;  ///< best first
  CauseFit fit;                       ///< with the one that was kept
};

struct SearchResult : CauseSet {
  std::vector<Rung> ladder;
  /// Those that explained the train part best but not what a fit did not see.
  std::vector<FittedCause> refuted;
  /// Whether the problem served to the end (SearchOptions::serves).
  bool served = true;
  /// Whether other causes have been tried in the place of each.
  bool exchanged = false;
  /// Whether a screening of what is left shows any candidate to be significant.
  bool significant_rest = false;
};

/// @param before  a search of the same record, with another observer or other physics
///                steps, to go on from; or null
SearchResult SearchCauses(const DiscoveryProblem& problem,
                          const std::vector<Candidate>& candidates,
                          const SearchOptions& options,
                          const SearchResult* before = nullptr);

}  // namespace mjdiag
