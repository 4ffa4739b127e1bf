#pragma once
// The answer of a discovery in a word; verdict.h says how it follows from the evidence.

#include <string>

namespace mjdiag {

enum class DiscoveryVerdict {
  kNoDiscrepancy,    ///< noise explains the record
  kExplained,        ///< causes were found, noise explains the rest
  kPartlyExplained,  ///< causes were found, something is left
  kUnexplained       ///< something is there, and no candidate is its cause
};

/// "no_discrepancy", "explained", "partly_explained", "unexplained".
std::string VerdictName(DiscoveryVerdict verdict);

}  // namespace mjdiag
