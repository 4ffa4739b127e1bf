#pragma once
// Dry friction by MuJoCo's own constraint: what sticks, sticks exactly, up to a bound.
// It takes bound |v| of power, and the bound is never negative: passive, whatever it
// follows.

#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {

/// Adds to the bound of a joint [N, N m], with the solver parameters that the model has for
/// it, or as stiff as the time step allows where it has those of MuJoCo.
void AddDryFriction(mjModel& model, int joint, double force);
/// Takes such a bound off again; what was there before it stays.
void TakeDryFriction(mjModel& model, int joint, double force);

/// Whether solreffriction or solimpfriction is not what MuJoCo sets by default: somebody has
/// said how that joint sticks.
bool HasOwnFrictionSolver(const mjModel& model, int dof);
/// Solver parameters that make a friction constraint behave as exact dry friction. The
/// default ones are far too soft for a precision stage: it creeps.
void StiffenFriction(mjModel& model, int dof);

/// Dry friction of one bound, -force sign(v), however its joint sticks at rest.
class ConstantFrictionEffect : public Effect {
 public:
  using Effect::Effect;
  std::optional<ModelParameter> Number(const mjModel&, int joint) const final {
    return ModelParameter{ModelParameterKind::kFriction, joint};
  }
  std::optional<double> Law(double v, const EffectValues& values) const final {
    return -values[0] * Sign(v);
  }
  Sized Draw(const Scales& k, Random&) const final {
    return Proportional(k.FrictionForce());
  }
};

/// A bound that changes from step to step. MuJoCo makes no constraint where the bound
/// is zero, so the plant has to have one, however small: kLeastBound.
class VaryingBound : public ActiveEffect {
 public:
  explicit VaryingBound(int dof) : dof_(dof) {}
  void Bind(const mjModel& model, mjData& data) noexcept final;

 protected:
  int dof() const { return dof_; }

 private:
  /// What is added to the bound in this step [N, N m]; less than nothing takes off what
  /// other friction of the joint has, as far as there is any.
  virtual double Added(const mjModel& model, mjData& data) noexcept = 0;

  int dof_;
};
inline constexpr double kLeastBound = 1e-12;  // [N, N m]

/// Dry friction with a bound that the model has and one that changes.
/// @tparam Bound  VaryingBound, made from a JointOf and the EffectValues
template <class Bound>
class VaryingFrictionEffect : public Effect {
 public:
  using Effect::Effect;
  void Apply(mjModel& model, int joint, const EffectValues& values) const final {
    AddDryFriction(model, joint, std::max(Constant(values), kLeastBound));
  }
  void Retract(mjModel& model, int joint, const EffectValues& values) const final {
    TakeDryFriction(model, joint, std::max(Constant(values), kLeastBound));
  }
  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const final {
    return std::make_unique<Bound>(JointOf(model, joint), values);
  }

 private:
  virtual double Constant(const EffectValues&) const { return 0.0; }  // [N, N m]
};

}  // namespace mjdiag
