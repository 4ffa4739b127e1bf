#pragma once
// The exact discrete plant of a control tick in the form in which residuals are
// synthesised: the delta operator
//
//   p = (z - 1) / kDeltaScale,   p x = A x + B u,   y = C x
//
// in coordinates of unit mass (w = L^T q with M = L L^T, velocities times the tick).
// Slow modes, whose poles crowd at z = 1, keep their digits in it, and every entry is
// of order one or less: the null space that follows is separated from the rest by more
// than ten decades.

#include <Eigen/Core>

#include "mjdiag/diagnosis/model/dae_model.h"
#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// Poles of a sampled machine lie within 2 of z = 1; half of that keeps powers of p
/// tame.
inline constexpr double kDeltaScale = 0.5;

/// How the machine is stepped: `substeps` Euler steps of `step` [s] a control tick.
struct TickTiming {
  double step = 0.0;
  int substeps = 1;
  double tick() const { return step * substeps; }
};

/// A, B, C, D of p for the tick of TickModel; sample_time is the tick [s].
StateSpace DeltaForm(const MechanicalModel& model, const TickTiming& timing);

/// Where generalised forces that are held over a tick enter the delta form: B_f of
/// external faults and of parametric faults ([AB383], Eq. 10 and 11, there the unit
/// vector of the joint), B_d of unknown disturbances.
/// @param forces  nq x n, generalised force per unit of each signal
SignalEntry HeldForces(const MechanicalModel& model, const TickTiming& timing,
                       const Eigen::MatrixXd& forces);

}  // namespace mjdiag
