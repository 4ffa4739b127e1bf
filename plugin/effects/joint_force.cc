#include "mjdiag/plugin/effects/joint_force.h"

#include <utility>

namespace mjdiag {
namespace {

class JointForce final : public ActiveEffect {
 public:
  JointForce(const JointForceEffect& effect, const JointOf& joint, EffectValues values)
      : effect_(effect), joint_(joint), values_(std::move(values)) {}
  bool FollowsItsJoint() const noexcept override { return true; }
  void Push(const mjModel&, mjData& data) noexcept override {
    const double q = data.qpos[joint_.position] - joint_.rest;
    const double v = data.qvel[joint_.dof];
    data.qfrc_applied[joint_.dof] += effect_.Force(q, v, data.time, values_);
  }

 private:
  const JointForceEffect& effect_;
  JointOf joint_;
  EffectValues values_;
};

class JointDamping final : public ActiveEffect {
 public:
  JointDamping(const JointDampingEffect& effect, const JointOf& joint,
               EffectValues values)
      : effect_(effect), joint_(joint), values_(std::move(values)) {}
  bool FollowsItsJoint() const noexcept override { return true; }
  double Damping(const mjModel&, const mjData& data) const noexcept override {
    const double q = data.qpos[joint_.position] - joint_.rest;
    return effect_.Damping(q, data.qvel[joint_.dof], values_);
  }

 private:
  const JointDampingEffect& effect_;
  JointOf joint_;
  EffectValues values_;
};

}  // namespace

std::unique_ptr<ActiveEffect> JointForceEffect::Activate(
    const mjModel& model, const Channels&, int element,
    const EffectValues& values) const {
  return std::make_unique<JointForce>(*this, JointOf(model, element), values);
}

std::optional<double> JointForceEffect::Law(double x,
                                            const EffectValues& values) const {
  if (variable() == LawVariable::kPosition) return Force(x, 0.0, 0.0, values);
  if (variable() == LawVariable::kVelocity) return Force(0.0, x, 0.0, values);
  return std::nullopt;
}

std::unique_ptr<ActiveEffect> JointDampingEffect::Activate(
    const mjModel& model, const Channels&, int element,
    const EffectValues& values) const {
  return std::make_unique<JointDamping>(*this, JointOf(model, element), values);
}

std::optional<double> JointDampingEffect::Law(double x,
                                              const EffectValues& values) const {
  if (variable() != LawVariable::kVelocity) return std::nullopt;
  return -Damping(0.0, x, values) * x;
}

}  // namespace mjdiag
