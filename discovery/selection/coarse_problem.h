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
///
/// Numbers in doubt are fitted down to the noise before there is any cause, and there long
/// steps are never near. Beside them the coarse problem is shifted by what its steps are
/// off by beside those changes: it is exact there, and near as long as a machine stays
/// like them. What a shift would be that is not small beside noise, nor beside what is
/// left to explain, nobody knows a little away: then there is none.
std::optional<DiscoveryProblem> Coarsen(const DiscoveryProblem& problem,
                                        const Changes& changes);

}  // namespace mjdiag
