#pragma once
// Effects that MuJoCo does not have, as generalised forces in every physics step.

#include <mujoco/mujoco.h>

#include <memory>
#include <vector>

#include "mjdiag/plugin/effect.h"

namespace mjdiag {

class ForceEffect {
 public:
  virtual ~ForceEffect() = default;
  /// Adds its force to data.qfrc_applied, from positions and velocities of this step.
  virtual void AddForce(const mjModel& model, mjData& data) noexcept = 0;
};

/// All force effects of a run: those the MJCF carries and `added`.
class ForceEffects {
 public:
  /// InputError as CheckEffect.
  ForceEffects(const mjModel& model, const std::vector<EffectSpec>& added);
  /// Sets data.qfrc_applied of the joints that have such effects. Call once a physics
  /// step, before the accelerations.
  void Apply(const mjModel& model, mjData& data) noexcept;
  /// Takes them off again.
  void Release(mjData& data) noexcept;

 private:
  std::vector<std::unique_ptr<ForceEffect>> effects_;
  std::vector<int> dofs_;
};

}  // namespace mjdiag
