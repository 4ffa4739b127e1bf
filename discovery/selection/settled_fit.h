#pragma once
// Sets of causes are compared by single units of a criterion, so that their fits have to
// be as near to their ends. A fit by secants (cause_fit.h) starts from derivatives of the
// set before it, under what is known beforehand weighed as beside what that set left.
// Beside a cause that explains much of the mismatch both are wrong, and it stalls far from
// its end, by hundreds of units where the mismatch is large.

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

/// The fit, gone on with from derivatives made anew, with what is known beforehand
/// weighed as beside what it leaves itself (Inflation), until a round gains less than a
/// unit of the deviance, or for the fifth time, or until its share of the work, to which
/// what the fit has spent belongs, is done. Where it cannot go on, as it is.
CauseFit Settled(const DiscoveryProblem& problem,
                 const std::vector<Candidate>& candidates, CauseFit fit, double share);

}  // namespace mjdiag
