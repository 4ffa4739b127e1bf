#pragma once
// The linear equations of motion of a machine, the value that every method of
// diagnosis starts from:
//
//   M q'' + D q' + K q = Gamma u,    y = b^T q        ([AB383], Eq. 2 and 3)
//
// q: deviation of the joint coordinates from the static equilibrium, K with the
// gravity stiffness in it.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/signals/state_space.h"

namespace mjdiag {

struct MechanicalModel {
  std::vector<std::string> coordinates;  ///< joint names, nq
  std::vector<std::string> inputs;       ///< actuator channels, nu
  std::vector<std::string> outputs;      ///< sensor channels, ny
  Eigen::MatrixXd M;                     ///< nq x nq  [kg, kg m, kg m^2]
  Eigen::MatrixXd D;                     ///< nq x nq  [N s/m, N m s/rad]
  Eigen::MatrixXd K;                     ///< nq x nq  [N/m, N m/rad]
  Eigen::MatrixXd Gamma;  ///< nq x nu  generalised force per unit of input
  Eigen::MatrixXd b;      ///< nq x ny  y = b^T q
};

/// A damped mode; over-damped pairs appear as two entries with damping_ratio 1 and
/// frequency |lambda| / 2 pi.
struct Mode {
  double frequency = 0.0;      ///< |lambda| / (2 pi) [Hz]
  double damping_ratio = 0.0;  ///< -Re(lambda) / |lambda|
  Eigen::VectorXd shape;       ///< |q| part of the eigenvector, nq, largest entry 1
};

/// Modes in order of frequency; rigid-body poles at zero are left out.
std::vector<Mode> Modes(const MechanicalModel& model);

/// x = [q; q'], [AB383], Eq. 9. NumericalError if M is not positive definite.
StateSpace ContinuousStateSpace(const MechanicalModel& model);

/// The same system for numerical work: time in multiples of `time_unit` [s] and states
/// in coordinates of unit mass, w = L^T q with M = L L^T. Inputs and outputs as before.
StateSpace UnitMassStateSpace(const MechanicalModel& model, double time_unit);

/// A unit of time [s] near the fastest mode: in it, all entries of the dynamics of
/// UnitMassStateSpace are of order one or less.
double FastTimeUnit(const MechanicalModel& model);

/// The exact discrete map of one control tick of `substeps` semi-implicit Euler steps
/// of length `step` [s] with u held, as MuJoCo's Euler integrates it:
///   v+ = v + h (M + h D)^-1 (-K q - D v + Gamma u),   q+ = q + h v+
/// x = [q; v]; y is read at the start of the tick.
StateSpace TickModel(const MechanicalModel& model, double step, int substeps);

}  // namespace mjdiag
