#pragma once
// A simulator that shares no step with mjdiag's: the accelerations are MuJoCo's (mass
// matrix, bias, springs, dampers, contacts), everything else is here. Between two control
// ticks, in which the commands of the motors hold,
//
//   M(q) q'' = f(q, q', u) + hidden forces - dry friction,   u = drive(command(t - late))
//
// is integrated by explicit Runge-Kutta steps of fourth order. Dry friction is ideal: over
// a step it is the force that would end the sliding (dry_friction.h), where MuJoCo's creeps.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <functional>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "support/hidden_cases/hidden_physics.h"

namespace mjdiag::test {

struct OwnRun {
  Eigen::Index ticks = 0;
  int steps = 16;  ///< Runge-Kutta steps a control tick
  /// Where it begins, nq; empty: where the machine rests.
  Eigen::VectorXd start = {};
};

/// Runs the machine, its own numbers and what is hidden in it. `computer` reads the
/// encoders and commands the motors once a tick, and keeps the record.
/// InputError if a joint is neither slide nor hinge; NumericalError where it diverges.
void RunOwn(const Machine& machine, const HiddenPhysics& hidden, TickControl& computer,
            const OwnRun& run);

}  // namespace mjdiag::test
