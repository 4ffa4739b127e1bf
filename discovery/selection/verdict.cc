#include "mjdiag/discovery/selection/verdict.h"

#include <algorithm>

namespace mjdiag {

DiscoveryVerdict VerdictOf(const SearchResult& search, bool named, double nominal) {
  constexpr double kNamedShare = 0.9;
  const double left = search.fit().train;
  if (!named) {
    const bool something = !search.ladder.empty() || search.significant_rest;
    return something ? DiscoveryVerdict::kUnexplained
                     : DiscoveryVerdict::kNoDiscrepancy;
  }
  if (!search.significant_rest && left <= kFarAboveNoise) {
    return DiscoveryVerdict::kExplained;
  }
  const double excess = nominal - 1.0;
  const double rest = std::max(left - 1.0, 0.0);
  const double share = excess > 0.0 ? 1.0 - rest / excess : 0.0;
  return share >= kNamedShare ? DiscoveryVerdict::kPartlyExplained
                              : DiscoveryVerdict::kUnexplained;
}

std::string VerdictName(DiscoveryVerdict verdict) {
  switch (verdict) {
    case DiscoveryVerdict::kNoDiscrepancy:
      return "no_discrepancy";
    case DiscoveryVerdict::kExplained:
      return "explained";
    case DiscoveryVerdict::kPartlyExplained:
      return "partly_explained";
    case DiscoveryVerdict::kUnexplained:
      return "unexplained";
  }
  return "";
}

}  // namespace mjdiag
