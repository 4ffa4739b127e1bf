#pragma once
// The search for causes: a set of hypotheses grows by one at a time, and every other
// move that the larger set suggests is tried before the next.
//
// A round
//
//   screens all candidates on what is left; where one shows, it may be what another
//   hypothesis in the place of one does (moves.h), or else the best of them are fitted
//   beside what has been found (addition.h); in the order of their criteria they are
//   judged, and the first that is accepted is added;
//   tries other periods for waves and simpler laws, gives up what is no longer credible, and
//   drops what has become superfluous (moves.h);
//   where the course of the machine depends on the last digit, looks for a better fit
//   around the one that derivatives led to (unsteady_fit.h).
//
// Where unseen data turn down what explains the fitted part, it may be half of the truth:
// up to two such hypotheses are added ahead, and taken back if what comes with them does
// not make unseen data agree with all of them.
//
// When a round adds nothing each hypothesis is exchanged on trial, and two for one
// (moves.h); if one is, rounds go on, four times at most. What came first was chosen while
// everything else was missing: for each hypothesis a search of its own, which may not take
// it, starts from the others, and its set is judged as any other. In the end all values
// are fitted once more, as closely as possible.
//
// Where the work that the discovery may do is used up, or it was asked to end (work.h),
// no further move is begun, and those under way end with the sets they have.
//
// One comparator judges all of these moves (comparator.h). A set that it turns down
// leaves no trace but, if unseen data spoke against it, its name among the refuted.

#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/selection/hypothesis.h"

namespace mjdiag {

struct SearchOptions {
  int most_causes = 6;
  int shortlist = 8;  ///< candidates a round that are fitted
  /// Another record of the machine: what makes its innovations larger is no cause. Not
  /// owned, may be null.
  const MeasuredRun* unseen = nullptr;
  /// FreeRun (record_replay.h) of the same: what is far above noise must not grow. May
  /// be empty.
  std::function<double(const Changes& changes)> free_run;
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
  /// Whether other causes are tried in the place of each, and other sets without it.
  bool exchange = true;
  /// Candidates that are not looked at.
  std::vector<std::size_t> forbidden;
  /// What is tried, which share of a round is done, and the best set so far.
  std::function<void(const std::string& what, double fraction, const CauseFit& best)>
      progress;
};

struct SearchResult : HypothesisSet {
  /// The causes after each that was added; it is their last.
  std::vector<FittedModel> ladder;
  /// The numbers of the plant without any cause.
  Eigen::VectorXd numbers_alone;
  /// Those that explained the train part best but not what a fit did not see, each as it
  /// was last.
  std::vector<FittedCause> refuted;
  /// Whether the problem served to the end (SearchOptions::serves).
  bool served = true;
  /// Whether other causes have been tried in the place of each, and other sets without it.
  bool exchanged = false;
  bool searched_without = false;
  /// Whether a screening of what is left shows any candidate to be significant; true
  /// until one has taken place.
  bool significant_rest = false;
  bool screened = false;
};

/// @param before  a search of the same record, with another observer or other physics
///                steps, to go on from; or null
SearchResult SearchCauses(const DiscoveryProblem& problem,
                          const std::vector<Candidate>& candidates,
                          const SearchOptions& options,
                          const SearchResult* before = nullptr);

}  // namespace mjdiag
