#pragma once
// Machines whose course depends on the last digit: with backlash and dry friction any
// change, however small, may make a replay stick and slip at other instants, and the
// sum of squares is a smooth bowl under a rough surface. A descent by
// gradients ends somewhere on it.

#include <optional>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// By how much the squared scaled innovations of the train part change with changes of
/// the found causes that do not matter (1e-7): what a further cause has to exceed, for
/// less may be another throw of the dice. Three times the spread of three runs, for the
/// best of some dozen throws.
double Unsteadiness(const DiscoveryProblem& problem,
                    const std::vector<Candidate>& candidates, const CauseFit& fit);

/// The best of the places around a fit, up to a tenth of every parameter away, if it
/// explains more by `least_gain` of squared innovations; none where nothing more may be
/// begun (Work::MayBegin).
std::optional<CauseFit> LookAround(const DiscoveryProblem& problem,
                                   const std::vector<Candidate>& candidates,
                                   const CauseFit& fit, double least_gain);

}  // namespace mjdiag
