#pragma once
// How sure a fit is of its parameters.
//
// The covariance of theta holds for innovations of any colour (the "sandwich" of Huber
// and White with the lags of Newey and West):
//
//   cov = (J^T J)^-1 B (J^T J)^-1,  B = sum over lags l of w_l sum_k s_k s_(k+l)^T,
//   s_k = J_k^T e_k,   w_l = 1 - |l| / (m + 1)
//
// What is known of the numbers of the plant beforehand adds I to J^T J and to B.

#include <Eigen/Core>

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

/// Covariance of theta; infinite variance where the data say nothing.
Eigen::MatrixXd ParameterCovariance(const DiscoveryProblem& problem,
                                    const CauseFit& fit);

}  // namespace mjdiag
