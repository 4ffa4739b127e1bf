#pragma once
// The numbers of a plant fitted alone, before any cause is looked for.
//
// What they leave is not noise but whatever the plant lacks, and would pull them anywhere
// if it counted as measurements do. What is known beforehand therefore counts as much more
// as what is left is larger than noise and as fewer of its values are independent
// (FittedModel::prior_weight); where the numbers are all there is, that ends with noise.

#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

/// Without numbers nothing is fitted.
/// @param start  numbers to start from, found with other physics steps; empty: all at 0
/// @param share  see FitOptions
CauseFit FitNumbers(const DiscoveryProblem& problem,
                    const std::vector<Candidate>& candidates,
                    const Eigen::VectorXd& start, double share);

}  // namespace mjdiag
