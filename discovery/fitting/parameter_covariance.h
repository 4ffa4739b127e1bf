#pragma once
// How sure a fit is of its parameters.
//
// The covariance of theta holds for innovations of any colour (the "sandwich" of Huber
// and White with the lags of Newey and West):
//
//   cov = (J^T J)^-1 B (J^T J)^-1,  B = sum over lags l of w_l sum_k s_k s_(k+l)^T,
//   s_k = J_k^T e_k,   w_l = 1 - |l| / (m + 1)
//
// What is known beforehand of the numbers of the plant and of the sizes of causes, with
// precision P and weight w (FittedModel), adds w P to J^T J and w^2 P to B.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

/// J^T J of the part that the fit saw, and what is known beforehand, with
/// theta_i = scale_i theta'_i: parameters of all units alike.
struct ScaledInformation {
  Eigen::MatrixXd jacobian;  ///< J diag(scale), values of the fit x parameters
  Eigen::VectorXd scale;
  Eigen::VectorXd known;  ///< beforehand, weighted, on the diagonal
  Eigen::MatrixXd matrix;
};
ScaledInformation InformationOf(const DiscoveryProblem& problem,
                                const std::vector<Candidate>& candidates,
                                const CauseFit& fit);

/// The inverse of its matrix on what it tells of. A parameter that nothing is known of,
/// as where the part that it shapes is of no size, takes nothing from the others.
struct InverseInformation {
  Eigen::MatrixXd matrix;  ///< of theta'; 0 of parameters that are not told
  std::vector<bool> told;
};
InverseInformation InverseOf(const ScaledInformation& information);

/// Covariance of theta; infinite variance where the data say nothing.
Eigen::MatrixXd ParameterCovariance(const DiscoveryProblem& problem,
                                    const std::vector<Candidate>& candidates,
                                    const CauseFit& fit);

}  // namespace mjdiag
