#include "mjdiag/discovery/verdict.h"

namespace mjdiag {

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
