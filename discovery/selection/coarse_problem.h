#pragma once
// The same problem with fewer, longer physics steps a control tick: a search takes its
// time nearly in proportion to the number of steps. What it finds is where a search
// with all of them goes on from.

#include <optional>

#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// Whether the innovations beside those changes differ by less from those of `problem`
/// than a cause would have to explain to be significant. The more has been explained,
/// the less that is.
bool IsNear(const DiscoveryProblem& coarse, const DiscoveryProblem& problem,
            const Changes& changes);

/// The problem with one substep a tick, or two, if that is near beside those changes;
/// none if it is not, or has no more.
std::optional<DiscoveryProblem> Coarsen(const DiscoveryProblem& problem,
                                        const Changes& changes);

}  // namespace mjdiag
