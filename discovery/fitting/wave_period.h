#pragma once
// Other periods for a wave that was found. Where a motion stays in few places many
// periods explain nearly the same (aliases), and the first screening, beside a plant
// without the wave, is too rough to tell them apart. Beside the plant with the wave in
// it the first order is good to the noise, so the wave is screened again there, on what
// is left plus what it explains itself (screening_in_place.h).

#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// Whether a candidate has a period or a frequency: a wave over position or time, or a
/// resonance, whose mass is its amplitude.
bool HasPeriod(const Candidate& candidate);

/// Cause i with other periods (or frequencies) that promise more than the present one,
/// best first.
std::vector<FittedCause> OtherPeriods(const DiscoveryProblem& problem,
                                      const std::vector<Candidate>& candidates,
                                      const CauseFit& fit, std::size_t i);

}  // namespace mjdiag
