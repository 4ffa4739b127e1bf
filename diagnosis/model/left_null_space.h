#pragma once
// Left null space of H(p): the parity relations of which residuals are made, polynomial
// row vectors N with N H = 0. With H of a state space ([AB383], Eq. 13) that holds for
// N = [N_x, N_y] exactly when
//
//   sum_i N_y,i C A^i = 0   and   N_x,k = sum_{i>k} N_y,i C A^(i-k-1),
//
// so only N_y is sought, in the left null space of the stack [C; CA; ...; CA^d]. That
// is far smaller than the bar matrix of Eq. 19 and better conditioned, provided that
// the system is in a fitting unit of time (UnitMassStateSpace): in seconds the powers
// of A span 25 decades and double precision sees a null space that is not there.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/model/dae_model.h"
#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// [C; C A; ...; C A^degree], (degree + 1) ny x nx.
Eigen::MatrixXd ObservabilityStack(const StateSpace& system, int degree);

/// Rank of the observability stack for degrees 0 .. max_degree. (degree + 1) ny minus
/// the rank is the number of independent parity relations up to that degree.
std::vector<int> ObservabilityRanks(const StateSpace& system, int max_degree);

/// One coefficient of N_y that is given: of `output`, at p^power.
struct PinnedCoefficient {
  Eigen::Index output = 0;
  int power = 0;
  double value = 0.0;
};

/// The vector N of that degree with N H = 0 and the pinned coefficients in N_y.
/// NumericalError unless there is exactly one.
PolynomialMatrix LeftNullVector(const StateSpace& system, int degree,
                                const std::vector<PinnedCoefficient>& pins);

/// Parity relations: vectors N with N H = 0, as many as there are up to a degree.
struct NullSpace {
  int degree = 0;
  /// N_y of every relation, k x (degree + 1) ny: [N_y,0 .. N_y,degree]
  Eigen::MatrixXd relations;
  /// Smallest singular value of the equilibrated equations that counts, over the
  /// largest: how far the null space is from being wider than it is.
  double separation = 0.0;
};

/// All relations of that degree that are blind to the state and to unknown inputs d:
///   sum_i N_y,i C A^i = 0,   N_x,k B_d + N_y,k D_d = 0 for every k.
/// Without unknown inputs pass an entry of no columns, or leave it out. An empty basis
/// is a result, not an error. From the singular value decomposition of the equations
/// with rows and columns equilibrated.
NullSpace LeftNullSpace(const StateSpace& system, const SignalEntry& unknown_inputs,
                        int degree);
NullSpace LeftNullSpace(const StateSpace& system, int degree);

/// The smallest degree at which a parity relation exists. InputError with the ranks
/// found if there is none up to `max_degree`.
int MinimalDegree(const StateSpace& system, const SignalEntry& unknown_inputs,
                  int max_degree);

/// N from its output part: N_x by synthetic division, N_x,k-1 = N_x,k A + N_y,k C.
/// @param output_part  k x (degree + 1) ny
PolynomialMatrix CompleteRelations(const StateSpace& system,
                                   const Eigen::MatrixXd& output_part);

/// A parity relation between readings and commands in SI units: the numerators of the
/// residual r = sum_i outputs_i(s) y_i + inputs_j(s) u_j.
struct ParityRelation {
  Eigen::MatrixXd outputs;  ///< ny x (degree + 1), ascending powers of s
  Eigen::MatrixXd inputs;   ///< nu x (degree + 1), ascending powers of s
};

/// N(s) L of the continuous-time model; the pins are coefficients of `outputs`.
ParityRelation PinnedParityRelation(const MechanicalModel& model, int degree,
                                    const std::vector<PinnedCoefficient>& pins);

}  // namespace mjdiag
