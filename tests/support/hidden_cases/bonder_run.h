#pragma once
// A measurement of the wire bonder by the simulator of the tests: the encoders, noise and
// controllers of its setup.

#include <cstdint>

#include "mjdiag/controllers/trajectory.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"
#include "support/hidden_cases/hidden_physics.h"

namespace mjdiag::test {

struct Measurement {
  std::uint64_t seed = 1;
  double noise_scale = 1.0;
  int steps = 16;  ///< Runge-Kutta steps a control tick
};

/// Closed loop, of any machine that has controllers.
Record MeasureOwn(const Machine& machine, const HiddenPhysics& hidden,
                  const Trajectory& motion, const Measurement& how);

}  // namespace mjdiag::test
