#pragma once
// The bank of a machine: residual generators R ([AB383], Eq. 15) and for each fault
// the prefilters Phi (Eq. 24), all over one denominator.
//
// A machine whose faults have moved its parameters to f has other parity relations
// N(f) L(f) z = 0 than the healthy one. With R(f) z = 0 for the machine that has these
// faults, the residual of the healthy design is r = R(0) z = -(dR/df) f z + O(f^2), so
//
//   Phi_i = -dR/df_i,    r = sum_i Phi_i z f_i .
//
// Differentiating N H = 0 gives dN = -N dH H^+, hence Phi_i = N (dL_i - dH_i H^+ L) up
// to the sign of f: Eq. 24, with the delta matrices of Eq. 23 as dH, dL. It is computed
// here from the null spaces of machines with the fault changed by +c and -c, which
// stays accurate where the bar matrices of Eq. 24 are singular to working precision.
//
// Of the many relations that R(f) may move to, the one nearest to R in the metric of
// the output noise is taken. The noise of phi is then uncorrelated with that of every
// residual, and least squares of r on phi is free of errors-in-variables bias.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/diagnosis/residuals/filter_bank.h"
#include "mjdiag/diagnosis/residuals/residual_order.h"

namespace mjdiag {

/// Disturbances d of Eq. 10 to which residuals have to be blind; no columns: none.
struct UnknownInputs {
  Eigen::MatrixXd forces;    ///< nq x nd, generalised force per unit of each (B_d)
  Eigen::MatrixXd readings;  ///< ny x nd, sensor reading per unit of each (D_d)
};

struct SynthesisOptions {
  TickTiming timing;
  ResidualOrder residual;
  /// ny, standard deviation a sample; all 0: as for equal noise on every sensor
  Eigen::VectorXd sensor_noise;
  UnknownInputs unknown_inputs;
};

/// A fault parameter that the bank estimates: machines with it changed by -c and +c
/// (c of Eq. 22) about the point of design.
struct PerturbedModels {
  std::string name;
  double magnitude = 0.0;  ///< c
  MechanicalModel minus;
  MechanicalModel plus;
};

/// Parity relations of unit output noise that are blind to nominal motion: the whole
/// left null space of the degree, k of them, orthonormal in the noise of the filtered
/// output.
struct ResidualSpace {
  int degree = 0;
  double separation = 0.0;  ///< of the null space, see NullSpace
  Numerators relations;     ///< k x nz each
};

/// InputError if there is no parity relation of that degree.
ResidualSpace MakeResidualSpace(const MechanicalModel& model,
                                const SynthesisOptions& options);

/// Residual generators and prefilters. Output order of the bank: the residuals, then
/// for each fault its phi for every residual.
struct ResidualBank {
  Eigen::Index residuals = 0;
  Numerators relations;  ///< of the residuals, residuals x nz each
  std::vector<std::string> faults;
  FilterBank filters;
};

/// @param space         of the machine at the point of design, k relations
/// @param combinations  of them, n x k, each row of unit length
ResidualBank SynthesiseBank(const ResidualSpace& space,
                            const Eigen::MatrixXd& combinations,
                            const std::vector<PerturbedModels>& faults,
                            const SynthesisOptions& options);

/// The bank of combinations * (the residuals of `bank`): prefilters are linear in the
/// relations.
ResidualBank Mix(const ResidualBank& bank, const Eigen::MatrixXd& combinations);

/// combinations * relations, coefficient by coefficient.
Numerators Combine(const Eigen::MatrixXd& combinations, const Numerators& relations);

}  // namespace mjdiag
