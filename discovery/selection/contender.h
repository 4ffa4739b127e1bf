#pragma once
// Candidates in the race for one place among the causes. Probabilities of those that
// compete are exp(-BIC / 2) over their sum.

#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

struct Contender {
  FittedCause cause;
  double criterion = 0.0;  ///< BIC with it in place
  double probability = 0.0;
};

/// Puts the contenders in order, best first, of several starts of one candidate the
/// best only, and gives them their probabilities.
void Rank(std::vector<Contender>& contenders);

}  // namespace mjdiag
