#pragma once
// Which of the parity relations of a null space becomes the residual? With relations of
// unit output noise (MakeResidualSpace) a combination a of unit length has the noise of
// one of them, and its energy over a run with fault i is a^T G_i a.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/residuals/residual_bank.h"

namespace mjdiag {

/// G_i = sum_t phi_i,t phi_i,t^T of every fault: the energies per unit of each fault.
/// @param bank     with all relations of the space as residuals
/// @param signals  z = [y; u] of a healthy run, nz x N
std::vector<Eigen::MatrixXd> FaultEnergies(const ResidualBank& bank,
                                           const Eigen::MatrixXd& signals);

/// The unit vector with the largest product of a^T G_i a: no fault is given up for the
/// sake of another, and the scale of a fault parameter does not matter.
Eigen::VectorXd MostSensitiveRelation(const std::vector<Eigen::MatrixXd>& energies);

/// The combination a of least energy under nominal runs that are not nominal for the
/// linear model (friction, geometry), while it sees the fault: the convex quadratic
/// programme
///   minimise a^T Q a  subject to  g_j a >= 1
/// for each column g_j of the fault's response, the best of which is taken (Eq. 18 with
/// the objective of [AB383], section 6). Each has the solution Q^-1 g_j / g_j^T Q^-1
/// g_j. Returned with unit length.
/// @param nuisance  Q, k x k: energy of the relations over nominal runs, with their
///                  noise; positive definite, else NumericalError
/// @param response  g, k x m: response of the relations to the fault, for instance at m
///                  instants
Eigen::VectorXd LeastExcitedRelation(const Eigen::MatrixXd& nuisance,
                                     const Eigen::MatrixXd& response);

/// The unit vector with the largest ratio of a^T G a to a^T Q a: the same trade over a
/// whole run.
Eigen::VectorXd BestRatioRelation(const Eigen::MatrixXd& energy,
                                  const Eigen::MatrixXd& nuisance);

/// The same for several faults, or frequencies, at once: the largest product of
/// a^T G_i a / a^T Q_i a.
Eigen::VectorXd BestRatioRelation(const std::vector<Eigen::MatrixXd>& energies,
                                  const std::vector<Eigen::MatrixXd>& nuisances);

/// n orthonormal rows of which the first is `first`, 1 <= n <= size; 0 stands for all.
Eigen::MatrixXd CompleteBasis(const Eigen::VectorXd& first, int n);

}  // namespace mjdiag
