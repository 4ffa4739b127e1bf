#pragma once
// The verdict of an answer: what is left of the missing force.
//
// Left behind is compared with what was missing on data that no fit saw, as the filter of one
// noise, that of the machine as given, finds both: each joint's smoothed latent force less the
// error of its estimate, in units of what accelerates the joint,
//
//   share = sqrt( sum_j (left_j / s_j)^2 / sum_j (missing_j / s_j)^2 )
//
// Whether there is any at all says the likelihood of fitted data with the latent forces and
// without them, each of which is a size, a memory and a white part per joint; and it has to
// be more than a thousandth of what accelerates the joints.

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/comparison/disturbance_estimate.h"
#include "mjdiag/discovery/verdict.h"

namespace mjdiag {

struct MissingShare {
  double left = 0.0;        ///< share of what was missing, of forces
  bool is_missing = false;  ///< beside the machine as given
  bool is_left = false;     ///< beside the model
  /// Whether more is missing on data that no fit saw than beside the machine as given.
  bool IsWorse() const { return is_left && std::isfinite(left) && left > 1.0; }
};

MissingShare ShareLeft(const AnswerData& data, const UnseenJudgement& judged);

DiscoveryVerdict VerdictOf(const MissingShare& share, bool has_model);

/// The forces that a model lacks along what fits saw, or did not, behind the noise of the
/// machine as given.
/// @param changed  the machine with the model
/// @param path     of the machine as given
std::vector<DisturbanceEstimate> ForcesBeside(const Machine& changed,
                                              const MeasuredRun& run,
                                              const FilterPath& path);

}  // namespace mjdiag
