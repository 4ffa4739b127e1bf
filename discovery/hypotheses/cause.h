#pragma once
// A cause: a fault or an effect at a site with parameters, the answer to why a
// simulation differs from a measurement.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/effects/changes.h"

namespace mjdiag {

struct Cause {
  /// A turned knob is {knob, elements, {{"value", factor}}}, for example {"zeta_x",
  /// "X", {{"value", 1.2}}}; an effect is what EffectSpec says.
  EffectSpec spec;
  bool fault = false;
};

/// What the causes do to a plant.
Changes ChangesOf(const std::vector<Cause>& causes);

/// The knob as a cause at its healthy value.
Cause KnobCause(const mjModel& model, const FaultKnob& knob);

/// "zeta_x = 1.2", "coulomb_friction@load: force = 20.4".
std::string Describe(const Cause& cause);

/// True if both name the same fault, or the same effect at the same site.
bool SameKind(const Cause& a, const Cause& b);

/// True if a knob and an effect change the very same attribute of the model and nothing
/// else, so that no measurement tells them apart: damping of one joint and
/// viscous_friction, gear of one actuator and motor_constant, stiffness of one joint
/// and structural_stiffness.
bool Indistinguishable(const mjModel& model, const Cause& a, const Cause& b);

/// The causes that are indistinguishable from this one: of a knob of one element the
/// effect, of the effect the knob.
std::vector<Cause> Twins(const mjModel& model, const Cause& cause);

}  // namespace mjdiag
