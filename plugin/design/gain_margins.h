#pragma once
// How much stronger and weaker than they are the loops of a machine may be, whatever has
// become of its dampers and springs: the closed loop of the exact map of a control tick
// (ClosedLoopMatrix) over a grid of faults and gains. A correction of drive gains that
// stays in between leaves the machine stable even if it is wrong, or late: a fault that
// is gone of a sudden leaves a loop with the gain of its correction.

#include <Eigen/Core>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// Values that dampers and springs may have. Guides run dry and wear, and clamps work
/// loose: a damper may be several times what it was, a spring hardly more than it was.
struct FaultRange {
  double least_damping = 0.3;
  double most_damping = 3.0;
  double least_stiffness = 0.1;
  double most_stiffness = 1.2;
};

struct GainMargins {
  Eigen::VectorXd least;  ///< of every axis, times its loop gain
  Eigen::VectorXd most;
  double healthy_radius = 0.0;  ///< largest modulus of an eigenvalue, no fault
  double largest_radius = 0.0;  ///< within the margins and the range, on the grid
  double time_constant = 0.0;   ///< of the slowest mode, no fault [s]
};

/// Largest modulus of an eigenvalue of the closed loop.
/// @param parameters  values of the fault parameters
/// @param gains       of every axis, times its loop gain
double LoopRadius(const Machine& machine, const FaultFamily& family,
                  const Eigen::VectorXd& parameters, const Eigen::VectorXd& gains);

/// The widest gains, up to a factor of three, in which no mode decays more slowly than
/// three times the slowest of the healthy loop: more than stable, so that what lies
/// between the points of the grid is stable as well. NumericalError if the healthy loop
/// is not.
GainMargins FindGainMargins(const Machine& machine, const FaultFamily& family,
                            const FaultRange& range = {});

}  // namespace mjdiag
