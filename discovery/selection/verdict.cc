#include "mjdiag/discovery/selection/verdict.h"

#include <algorithm>

#include "mjdiag/discovery/selection/model_choice.h"

namespace mjdiag {

bool IsMoreLeft(const SearchResult& search) {
  return search.significant_rest || search.fit().train > kFarAboveNoise;
}

DiscoveryVerdict VerdictOf(const SearchResult& search, bool named, double nominal,
                           bool noise) {
  constexpr double kNamedShare = 0.5;
  const double left = search.fit().train;
  if (!named) {
    // Numbers may hide that something is there, but not from the noise; causes that were
    // dropped beside them were nothing else.
    const bool has_numbers = search.fit().numbers.size() > 0;
    const bool left_over = has_numbers && left > kFarAboveNoise;
    const bool found =
        has_numbers ? !search.fit().causes.empty() : !search.ladder.empty();
    const bool something = found || search.significant_rest || left_over;
    return something ? DiscoveryVerdict::kUnexplained
                     : DiscoveryVerdict::kNoDiscrepancy;
  }
  if (!IsMoreLeft(search) && noise) return DiscoveryVerdict::kExplained;
  const double excess = nominal - 1.0;
  const double rest = std::max(left - 1.0, 0.0);
  const double share = excess > 0.0 ? 1.0 - rest / excess : 0.0;
  return share >= kNamedShare ? DiscoveryVerdict::kPartlyExplained
                              : DiscoveryVerdict::kUnexplained;
}

}  // namespace mjdiag
