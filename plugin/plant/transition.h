#pragma once
// The linear map of a physics step and of a control tick of any plant, as MuJoCo's own
// integrator has it.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/plant/operating_point.h"
#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// x+ = A x + B u, y = C x + D u of deviations x = [q; v; act] in tangent coordinates, u and y
/// of the channels. Sensors are read where the step or the tick begins; u is held.
struct Transition {
  StateSpace step;
  StateSpace tick;
};

/// By central differences (mjd_transitionFD), static friction left out, constraints solved
/// to rounding. Of a motion the steps of a tick are those along it. A sensor that reads
/// accelerations or forces has D. Takes the control callback off meanwhile: not to be
/// called while simulations run in other threads.
Transition TransitionAbout(const mjModel& model, const Channels& channels,
                           const OperatingPoint& point, int substeps);

/// Names of x: "<coordinate>" of the positions, "<coordinate>'" of the velocities,
/// "<actuator>.act" of the activations.
std::vector<std::string> StateNames(const mjModel& model);

}  // namespace mjdiag
