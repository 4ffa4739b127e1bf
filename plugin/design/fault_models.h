#pragma once
// Linear models of a machine with its fault knobs turned.

#include <mujoco/mujoco.h>

#include <vector>

#include "mjdiag/diagnosis/refined_estimate.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// Every knob of the plant at its healthy value.
std::vector<Fault> HealthyKnobs(const mjModel& plant);

/// Magnitudes c of every knob of the plant, in its order. InputError if the setup names
/// a knob that the plant does not have.
Eigen::VectorXd Magnitudes(const Machine& machine);

/// The linear model for any knobs without linearising again: knobs scale dampers,
/// springs and motors, so that D, K and Gamma are affine in them as long as the
/// equilibrium stays where it is. Where a knob moves it, every call linearises.
ModelAt FaultModels(const Machine& machine);

/// For every knob the models with it turned by -c and +c from healthy; c from the
/// setup's magnitudes (Eq. 22 and 23 of the seed).
std::vector<TurnedModels> TurnModels(const Machine& machine);

/// Multisine disturbances of a setup on its actuators.
std::vector<Multisine> Multisines(const Setup& setup);

}  // namespace mjdiag
