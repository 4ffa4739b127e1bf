#include "mjdiag/discovery/selection/verdict.h"

#include <algorithm>

#include "mjdiag/discovery/selection/model_choice.h"

namespace mjdiag {

bool IsMoreLeft(const SearchResult& search) {
  return search.significant_rest || search.fit().train > kFarAboveNoise;
}

DiscoveryVerdict VerdictOf(const SearchResult& search, bool named, double nominal) {
  constexpr double kNamedShare = 0.9;
  const double left = search.fit().train;
  if (!named) {
    // Numbers may hide that something is there, but not from the noise.
    const bool left_over = search.fit().numbers.size() > 0 && left > kFarAboveNoise;
    const bool something =
        !search.ladder.empty() || search.significant_rest || left_over;
    return something ? DiscoveryVerdict::kUnexplained
                     : DiscoveryVerdict::kNoDiscrepancy;
  }
  if (!IsMoreLeft(search)) return DiscoveryVerdict::kExplained;
  const double excess = nominal - 1.0;
  const double rest = std::max(left - 1.0, 0.0);
  const double share = excess > 0.0 ? 1.0 - rest / excess : 0.0;
  return share >= kNamedShare ? DiscoveryVerdict::kPartlyExplained
                              : DiscoveryVerdict::kUnexplained;
}

}  // namespace mjdiag
