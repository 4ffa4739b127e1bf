#pragma once
// The information bound (Cramer and Rao): no unbiased estimator of the faults from the
// readings y and the known commands u has a smaller covariance than
//
//   Cov f^ >= I^-1,   I = sum_t S_t^T Q^-1 S_t,   S_t = d y_t / d f
//
// with white sensor noise of covariance Q = diag(sd^2) and the linear plant of a tick
// started at rest. The readings are simulated with the commands of the record held
// fixed: they are known, whatever loop made them.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/residuals/residual_bank.h"

namespace mjdiag {

struct InformationBound {
  Eigen::VectorXd alone;     ///< sd of each fault if the others are known, nf
  Eigen::VectorXd together;  ///< sd of each if all are unknown, nf
};

/// Sensitivities d y / d f by central differences over the perturbed models.
/// @param commands  nu x N
/// @return for each fault ny x N
std::vector<Eigen::MatrixXd> OutputSensitivities(
    const std::vector<PerturbedModels>& faults, const TickTiming& timing,
    const Eigen::MatrixXd& commands);

/// Readings of the healthy machine for an unknown input to the commands: the
/// sensitivity of a disturbance of known waveform.
/// @param waveform  nu x N
Eigen::MatrixXd OutputResponse(const MechanicalModel& healthy, const TickTiming& timing,
                               const Eigen::MatrixXd& waveform);

/// @param sensitivities  ny x N each
/// @param sensor_noise   ny, > 0; InputError on a sensor without noise, NumericalError
///                       if the faults cannot be told apart
InformationBound CramerRaoBound(const std::vector<Eigen::MatrixXd>& sensitivities,
                                const Eigen::VectorXd& sensor_noise);

}  // namespace mjdiag
