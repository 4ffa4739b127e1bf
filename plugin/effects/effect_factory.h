#pragma once
// How a specification becomes an ActiveEffect; one function for each family of the
// catalogue. They return null for effects that are not theirs.

#include <mujoco/mujoco.h>

#include <memory>

#include "mjdiag/plugin/effects/active_effect.h"

namespace mjdiag {

/// The degree of freedom of a joint effect, which `spec` is known to be.
struct JointOf {
  int dof = 0;
  int position = 0;   ///< in qpos
  double rest = 0.0;  ///< qpos0
};
JointOf FindJoint(const mjModel& model, const EffectSpec& spec);

std::unique_ptr<ActiveEffect> MakeFrictionEffect(const mjModel& model,
                                                 const EffectSpec& spec);
std::unique_ptr<ActiveEffect> MakeDriveEffect(const mjModel& model,
                                              const EffectSpec& spec);
std::unique_ptr<ActiveEffect> MakeStructureEffect(const mjModel& model,
                                                  const EffectSpec& spec);
/// Acts on the channels that read the sensor.
std::unique_ptr<ActiveEffect> MakeEncoderEffect(const Channels& channels,
                                                const EffectSpec& spec);

}  // namespace mjdiag
