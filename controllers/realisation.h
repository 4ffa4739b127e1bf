#pragma once
// Feedback controllers as discrete state space, for analysis of the closed loop.

#include "mjdiag/controllers/axis_controller.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// C(z) of a compensator in controllable canonical form, from the error (reference -
/// measured) to the command. InputError on an empty or improper compensator.
StateSpace Realise(const DiscreteCompensator& compensator, double sample_time);

/// The feedback part of the nested loops without their saturation, from -q to u:
///   C(z) = kp kv + kv (1 - z^-2) / (2 T)
DiscreteCompensator LinearFeedback(const NestedLoops& gains, double sample_time);

}  // namespace mjdiag
