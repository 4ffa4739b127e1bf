#pragma once
// The search for sets of causes. A model stands behind the observer that it deserves, the
// one behind which the record is likeliest (likelihood.h): as fast as the model is wrong. A
// round
//
//   proposes sets to add to it by one regression of what it leaves there, in which all
//   candidates, numbers and causes compete (set_regression.h);
//   fits each of them to the machine itself, by Gauss and Newton, first there and then,
//   step by step, behind slower observers, as long as these make the record likelier;
//   takes the likeliest, with what is known beforehand and ln n a parameter, if it takes
//   away a share of what the model lacked that is worth a name; and leaves out causes that
//   it does as well without, or puts a simpler law in the place of one at its end.
//
// Where the inputs of the machine seem to act later than in the simulation, by about what
// its physics steps are off by, the model is tried in twice as many steps; where the record
// is likelier with these, the search goes on in them. What is of second order in the steps
// no lateness makes good, and laws that are not there do.
//
// It ends where no set is worth it. As the model becomes right the observer becomes slow and
// sees what is small: sets of large effects come first, small ones in later rounds.

#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/sets/likelihood.h"

namespace mjdiag {

/// A model behind the observer that it deserves.
struct WeighedModel {
  CauseFit fit;
  std::size_t rung = 0;   ///< of the ladder
  double deviance = 0.0;  ///< -2 ln L of what the fit saw,
  double score = 0.0;     ///< and what is known beforehand, and ln n a parameter
};

struct SetSearchOptions {
  int most_causes = 8;
  std::function<void(const std::string& what, double fraction, const CauseFit& best)>
      progress;
};

struct SetSearchResult {
  WeighedModel given;  ///< the plant without causes, its numbers fitted
  WeighedModel best;
  /// The other models that were fitted in the last round that added causes.
  std::vector<WeighedModel> others;
  bool ended = false;  ///< no set was worth it; else there was no work left
  /// That `best` stands behind, in the physics steps that the record asks for.
  ObserverLadder ladder;
};

/// What a round takes at least [s of work].
double RoundWork(const DiscoveryProblem& problem);

SetSearchResult SearchSets(const ObserverLadder& ladder,
                           const std::vector<Candidate>& candidates,
                           const FittedModel& start, const SetSearchOptions& options);

}  // namespace mjdiag
