#pragma once
// Numbers of the plant to start a search from, as the twin of the machine learns them
// (number_learner.h): behind fast observers its first order holds however far the plant is
// off, where a fit behind the slow observer of a discovery would have to feel its way
// along directions that hardly any reading tells.

#include <optional>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

/// A fit without causes and with those numbers. None where the twin cannot be run, what is
/// left of the work does not allow for it, or the plant as it is given explains more.
/// @param problem  in the physics steps of the setup
std::optional<CauseFit> LearnedNumbersOf(const DiscoveryProblem& problem,
                                         const std::vector<Candidate>& candidates);

}  // namespace mjdiag
