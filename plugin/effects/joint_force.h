#pragma once
// Effects that are a force on a joint, a function of its motion and of time, and those
// that damp it, by more or less where it is and as it moves.

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

/// The degree of freedom of a joint.
struct JointOf {
  JointOf(const mjModel& model, int joint)
      : dof(model.jnt_dofadr[joint]),
        position(model.jnt_qposadr[joint]),
        rest(model.qpos0[position]) {}

  int dof;
  int position;  ///< in qpos
  double rest;   ///< qpos0
};

/// A force without a memory. Its law is that force over its variable, if that is the
/// position or the velocity.
class JointForceEffect : public Effect {
 public:
  using Effect::Effect;
  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int element,
                                         const EffectValues& values) const final;
  std::optional<double> Law(double x, const EffectValues& values) const override;
  /// [N, N m]. Neither allocates nor throws.
  /// @param q  position from qpos0   @param v  velocity   @param time  since the start
  virtual double Force(double q, double v, double time,
                       const EffectValues& values) const noexcept = 0;
};

/// -c v with a damping c that changes. Beside a damper that is there c may be less than
/// nothing; all that damps the joint together never drives it
/// (ActiveEffect::Damping).
class JointDampingEffect : public Effect {
 public:
  using Effect::Effect;
  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int element,
                                         const EffectValues& values) const override;
  /// The force over the velocity, of a damping that changes with that alone; without
  /// the joint's own damper.
  std::optional<double> Law(double x, const EffectValues& values) const override;
  /// c [N s/m, N m s]. Neither allocates nor throws.
  /// @param q  position from qpos0   @param v  velocity
  virtual double Damping(double q, double v,
                         const EffectValues& values) const noexcept = 0;
};

}  // namespace mjdiag
