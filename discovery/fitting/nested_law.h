#pragma once
// Laws that become a simpler one at an end of their parameters: a mass on an ever
// stiffer spring is a mere mass, Stribeck friction without breakaway is dry friction.
// The larger law never explains less; whether it explains more has to be asked.

#include <mujoco/mujoco.h>

#include <optional>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/candidate.h"

namespace mjdiag {

/// The simpler law at the same place, with values to start from; none if there is none,
/// or if it is no candidate. A fault parameter that is the same change of the plant
/// stands for it.
std::optional<FittedCause> SimplerLaw(const mjModel& plant,
                                      const std::vector<Candidate>& candidates,
                                      const FittedCause& cause);

/// A law that contains another one, with the values next to its own, in proportion, with
/// which it becomes that one as it is.
FittedCause Containing(const mjModel& plant, const std::vector<Candidate>& candidates,
                       FittedCause larger, const FittedCause& simpler);

}  // namespace mjdiag
