#pragma once
// Hypotheses that compete for one place in a set, and the set. Probabilities of those
// that compete are exp(-BIC / 2) over their sum.

#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/selection/evidence.h"

namespace mjdiag {

struct Hypothesis {
  FittedCause cause;
  double criterion = 0.0;  ///< BIC with it in place
  double probability = 0.0;
};

/// Puts the hypotheses in order, best first, of several starts of one candidate the
/// best only, and gives them their probabilities.
void Rank(std::vector<Hypothesis>& hypotheses);

/// Hypotheses that explain the record together.
struct HypothesisSet {
  Evidence evidence;
  /// Of every cause of the fit, which hypotheses could be in its place, itself
  /// included.
  std::vector<std::vector<Hypothesis>> rivals;

  const CauseFit& fit() const { return evidence.fit(); }
};

}  // namespace mjdiag
