#pragma once
// What the evidence of a search says of the whole record. With m the mean square of the
// innovations of the fitted part over sensor noise, m_0 the same of the plant as it was
// given:
//
//   no discrepancy    nothing was named, and nothing significant was found
//   explained         causes are named, nothing significant is left, m <= 4
//   partly explained  else, if they take away 1 - (m - 1) / (m_0 - 1) >= 0.9
//   unexplained       else: below that share of the excess over noise causes are not an
//                     explanation but the best of the wrong ones

#include <string>

#include "mjdiag/discovery/selection/search.h"

namespace mjdiag {

enum class DiscoveryVerdict {
  kNoDiscrepancy,    ///< noise explains the record
  kExplained,        ///< causes were found, noise explains the rest
  kPartlyExplained,  ///< causes were found, something is left
  kUnexplained       ///< something is there, and no candidate is its cause
};

/// Mean square of the innovations over sensor noise from which something is left,
/// whatever a screening says.
inline constexpr double kFarAboveNoise = 4.0;

/// @param named    whether there are causes, sensors that are noisier than known
///                 included
/// @param nominal  m_0
DiscoveryVerdict VerdictOf(const SearchResult& search, bool named, double nominal);

/// "no_discrepancy", "explained", "partly_explained", "unexplained".
std::string VerdictName(DiscoveryVerdict verdict);

}  // namespace mjdiag
