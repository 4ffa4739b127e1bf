#pragma once
// A cause: an effect or a changed fault parameter at a site with values, the answer to
// why a simulation differs from a measurement.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/effects/changes.h"

namespace mjdiag {

using Cause = PlacedEffect;

/// What the causes do to a plant.
Changes ChangesOf(const std::vector<Cause>& causes);

/// "zeta_x = 1.2", "coulomb_friction@load: force = 20.4".
std::string CauseWithValues(const Cause& cause);

/// True if both are the same effect at the same site, or a fault parameter and an
/// effect that change the very same attribute of the model and nothing else, so that
/// no measurement tells them apart: damping of one joint and viscous friction, gear of
/// one actuator and its motor constant, stiffness of one joint and that of the
/// structure.
bool Indistinguishable(const Cause& a, const Cause& b);

/// The causes that are indistinguishable from this one: of a fault parameter of one
/// element the effect, of the effect the fault parameters.
std::vector<Cause> EquivalentCauses(const mjModel& model, const Cause& cause);

}  // namespace mjdiag
