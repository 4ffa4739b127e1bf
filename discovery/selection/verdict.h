#pragma once
// What the evidence of a search says of the whole record. With m the mean square of the
// innovations of the fitted part over sensor noise, m_0 the same of the plant as it was
// given:
//
//   no discrepancy    nothing was named, nothing significant was found, and numbers of
//                     the plant, where they are in doubt, leave m <= 4
//   explained         causes are named, nothing significant is left, m <= 4, and the rest
//                     is like noise (completeness.h)
//   partly explained  else, if they take away 1 - (m - 1) / (m_0 - 1) >= 0.5
//   unexplained       else: what leaves the greater part of the excess over noise is not an
//                     explanation but the best of the wrong ones
//
// How certain names are beside what is left their probabilities say (completeness.h).

#include "mjdiag/discovery/selection/discovery_verdict.h"
#include "mjdiag/discovery/selection/search.h"

namespace mjdiag {

/// Whether the fit of a search leaves more than noise: what a screening says, or m > 4.
bool IsMoreLeft(const SearchResult& search);

/// @param named    whether there are causes, sensors that are noisier than known
///                 included
/// @param nominal  m_0
/// @param noise    whether the rest is like noise
DiscoveryVerdict VerdictOf(const SearchResult& search, bool named, double nominal,
                           bool noise);

}  // namespace mjdiag
