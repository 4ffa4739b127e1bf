#pragma once
// Values from which a fit gets on. What a screening finds is the first order: beside a
// machine that sticks and slips, and where two amplitudes act nearly alike, its values may
// lie where the machine does something else altogether, and no derivative there points
// back. A run is cheap beside a fit, so that some are tried before:
//
//   the amplitudes of the new cause as they are found, and each of them nearly alone, in
//   full and then in ever smaller shares of it, each with what is beside it as it was, and moved by
//   the first order, min over d of |r + J d|^2 + w |z + d_z|^2.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

/// The model with the first values of its last cause, and of what is beside it, that leave
/// no more than `enough`; if none do with those that leave the least.
/// @param jacobian  of the numbers and of the causes before the last; null if not known:
///                  they stay where they are
/// @param enough    mean square of the train part
FittedModel WithFirstValues(const DiscoveryProblem& problem,
                            const std::vector<Candidate>& candidates, FittedModel model,
                            const Eigen::MatrixXd* jacobian, double enough);

}  // namespace mjdiag
