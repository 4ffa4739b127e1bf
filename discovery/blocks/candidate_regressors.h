#pragma once
// CandidateRegressors of a candidate (plugin/effects/candidate_regressor.h): how its effect would show along the
// observed motion of a machine.

#include <optional>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/effects/candidate_regressor.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// All trials of a candidate on a small grid. Empty if the motion does not excite it,
/// or if it has a sweep instead.
std::vector<CandidateRegressor> MakeCandidateRegressors(const Machine& machine,
                                                        const Candidate& candidate,
                                                        const ObservedMotion& motion);

/// @param duration  of what is fitted [s], for the resolution of frequencies
std::optional<ParameterScan> MakeParameterScan(const Machine& machine,
                                               const Candidate& candidate,
                                               const ObservedMotion& motion,
                                               double duration);

}  // namespace mjdiag
