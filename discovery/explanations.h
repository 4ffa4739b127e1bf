#pragma once
// All sets of causes that a record leaves possible, with their probabilities.
//
// A search ends with one set, the causes that were named, and knows for the place of each
// of them who else could be there (FoundCause::alternatives). With p_i the probability of
// the cause named at place i and q_ij that of its alternative j, and places independent of
// each other beside the named set, the set with that one exchange is
//   q_ij / p_i
// times as likely as the named one; an alternative that no measurement tells from the
// named one is just as likely. Sets with more than one exchange are not considered, nor
// are such whose alternative is named at another place already.

#include <vector>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

struct CauseSet {
  std::vector<Cause> causes;
  double probability = 0.0;
};

/// Likeliest first, at most 8 and each of 1 % or more; none if nothing is named.
std::vector<CauseSet> ExplanationsOf(const std::vector<FoundCause>& named);

}  // namespace mjdiag
