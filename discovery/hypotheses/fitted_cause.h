#pragma once
// Candidates with values.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"

namespace mjdiag {

/// A candidate with values.
struct FittedCause {
  std::size_t candidate = 0;  ///< in the list of candidates
  Eigen::VectorXd value;      ///< in the order of candidate.parameters
};

Cause CauseOf(const std::vector<Candidate>& candidates, const FittedCause& fitted);
/// Changes to the plant that the causes are.
Changes ChangesOfFit(const std::vector<Candidate>& candidates,
                     const std::vector<FittedCause>& causes);

}  // namespace mjdiag
