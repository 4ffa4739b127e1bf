#pragma once
// Effects that MuJoCo has itself, put into the attributes of an mjModel:
//
//   coulomb_friction      dof_frictionloss, with solver parameters as stiff as the step
//                         allows
//   stribeck_friction     its constant part, in the same way
//   viscous_friction      dof_damping
//   linear_stiffness      jnt_stiffness, about the position that qpos0 has; a spring
//                         that is already there keeps its preload
//   structural_stiffness  jnt_stiffness times factor
//   added_mass            body_mass (slide), dof_armature (hinge)
//   motor_constant        actuator_gear times factor
//   force_saturation      actuator_forcerange

#include <mujoco/mujoco.h>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

/// Puts a native effect into the model (after CheckEffect); others leave it as it is.
/// InputError if the effect takes away more mass or damping than there is.
void ApplyNativeEffect(mjModel& model, const EffectSpec& effect);

/// Solver parameters that make a friction constraint behave as exact dry friction. The
/// default ones are far too soft for a precision stage: it creeps.
void StiffenFriction(mjModel& model, int dof);

}  // namespace mjdiag
