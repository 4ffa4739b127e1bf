#pragma once
// What a search works on, and its moves (addition.h, moves.h).

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/selection/evidence.h"

namespace mjdiag {

struct SearchData {
  const DiscoveryProblem& problem;
  DiscoveryProblem beginning;  ///< of the problem, for what shows early
  const std::vector<Candidate>& candidates;
  EvidenceData evidence;
  std::vector<std::size_t> forbidden = {};  ///< candidates that are not looked at

  bool IsForbidden(std::size_t candidate) const {
    return std::ranges::find(forbidden, candidate) != forbidden.end();
  }

  /// SimplerLaw of a cause, if it may stand beside the others of its model.
  std::optional<FittedCause> SimplerThan(const FittedCause& cause,
                                         const FittedModel& model) const;

  /// The model with the law that its last cause is, if it is at an end of its parameters.
  std::optional<FittedModel> AtItsEnd(const FittedModel& model) const;

  Work& work() const { return *problem.work(); }
};

}  // namespace mjdiag
