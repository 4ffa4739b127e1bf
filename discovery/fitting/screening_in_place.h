#pragma once
// Which candidates could stand in the place of causes that were found. Beside a plant
// without those the first order is rough, for they are large; beside the plant with them
// it is good, and what they take away can be put back to first order,
//
//   e - sum_j s_j de/ds_j,   e innovations, s_j the sizes of the causes,
//
// which is the derivative by one factor that all of their sizes have in common.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/screening/screening.h"

namespace mjdiag {

/// What could explain what causes in some places do. Causes without a size, as a limit
/// or a gap, are taken out of the plant instead.
/// @param starts_each  how many starts of one candidate to keep at most
Screening ScreenInPlace(const DiscoveryProblem& problem,
                        const std::vector<Candidate>& candidates, const CauseFit& fit,
                        const std::vector<std::size_t>& places, int starts_each);

/// Innovations of the train part without what causes in some places do, to first order;
/// none where one of them has no size.
std::optional<Eigen::VectorXd> InnovationsWithout(
    const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
    const CauseFit& fit, const std::vector<std::size_t>& places);

/// What the causes in these places explain of what is left without them, of which the
/// screening says how much that is: squared innovations, less what is known beforehand.
double ExplainedBy(const DiscoveryProblem& problem, const CauseFit& fit,
                   const Screening& in_place);

/// Squared innovations that there are more of without cause i, to first order: what its
/// sizes take away, less what all other parameters would take over. 0 where it has none,
/// or the fit has no derivatives.
double LossWithout(const DiscoveryProblem& problem,
                   const std::vector<Candidate>& candidates, const CauseFit& fit,
                   std::size_t i);

}  // namespace mjdiag
