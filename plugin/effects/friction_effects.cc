// Friction and hysteresis at a joint. v: its velocity; h: the physics step.

#include <cmath>

#include "mjdiag/plugin/effects/effect_factory.h"

namespace mjdiag {
namespace {

/// Dry friction whose bound falls with speed:
///   F = coulomb + breakaway exp(-(v / velocity)^2)
/// as the bound of MuJoCo's own friction constraint, so that it sticks exactly. The
/// constraint, with the constant part, is native (native_effect.h); here the part that
/// falls with speed is added.
class StribeckFriction final : public ActiveEffect {
 public:
  StribeckFriction(const EffectSpec& spec, int dof)
      : breakaway_(spec.Value("breakaway")),
        velocity_(spec.Value("velocity")),
        dof_(dof) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    const double ratio = data.qvel[dof_] / velocity_;
    for (int i = 0; i < data.nefc; ++i) {
      if (data.efc_type[i] != mjCNSTR_FRICTION_DOF || data.efc_id[i] != dof_) continue;
      data.efc_frictionloss[i] += breakaway_ * std::exp(-ratio * ratio);
    }
  }

 private:
  double breakaway_;
  double velocity_;
  int dof_;
};

class AsymmetricViscousFriction final : public ActiveEffect {
 public:
  AsymmetricViscousFriction(const EffectSpec& spec, int dof)
      : positive_(spec.Value("positive")),
        negative_(spec.Value("negative")),
        dof_(dof) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    const double v = data.qvel[dof_];
    data.qfrc_applied[dof_] -= (v > 0.0 ? positive_ : negative_) * v;
  }

 private:
  double positive_;
  double negative_;
  int dof_;
};

class QuadraticDrag final : public ActiveEffect {
 public:
  QuadraticDrag(const EffectSpec& spec, int dof)
      : coefficient_(spec.Value("coefficient")), dof_(dof) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    const double v = data.qvel[dof_];
    data.qfrc_applied[dof_] -= coefficient_ * v * std::abs(v);
  }

 private:
  double coefficient_;
  int dof_;
};

/// Follows a motion with a memory of `length` (Dahl): over a step with velocity v
///   z <- s L + (z - s L) exp(-|v| h / L),  s = sign(v)
/// which solves dz/dt = v - |v| z / L exactly.
class Follower {
 public:
  explicit Follower(double length) : length_(length) {}
  double Step(double v, double h) noexcept {
    const double end = std::copysign(length_, v);
    z_ = end + (z_ - end) * std::exp(-std::abs(v) * h / length_);
    return z_;
  }

 private:
  double length_;
  double z_ = 0.0;
};

/// P. R. Dahl, "A solid friction model", 1968: F = stiffness z with length
/// force / stiffness.
class PreslidingHysteresis final : public ActiveEffect {
 public:
  PreslidingHysteresis(const EffectSpec& spec, int dof)
      : stiffness_(spec.Value("stiffness")),
        follower_(spec.Value("force") / stiffness_),
        active_(spec.Value("force") > 0.0),
        dof_(dof) {}
  void Push(const mjModel& model, mjData& data) noexcept override {
    if (!active_) return;
    data.qfrc_applied[dof_] -=
        stiffness_ * follower_.Step(data.qvel[dof_], model.opt.timestep);
  }

 private:
  double stiffness_;
  Follower follower_;
  bool active_;
  int dof_;
};

class HystereticStiffness final : public ActiveEffect {
 public:
  HystereticStiffness(const EffectSpec& spec, const JointOf& joint)
      : stiffness_(spec.Value("stiffness")),
        loss_(spec.Value("loss")),
        follower_(spec.Value("length")),
        joint_(joint) {}
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double z = follower_.Step(data.qvel[joint_.dof], model.opt.timestep);
    const double q = data.qpos[joint_.position] - joint_.rest;
    data.qfrc_applied[joint_.dof] -= stiffness_ * (q + loss_ * z);
  }

 private:
  double stiffness_;
  double loss_;
  Follower follower_;
  JointOf joint_;
};

}  // namespace

std::unique_ptr<ActiveEffect> MakeFrictionEffect(const mjModel& model,
                                                 const EffectSpec& spec) {
  const auto dof = [&] { return FindJoint(model, spec).dof; };
  if (spec.effect == "stribeck_friction") {
    return std::make_unique<StribeckFriction>(spec, dof());
  }
  if (spec.effect == "asymmetric_viscous_friction") {
    return std::make_unique<AsymmetricViscousFriction>(spec, dof());
  }
  if (spec.effect == "quadratic_drag") {
    return std::make_unique<QuadraticDrag>(spec, dof());
  }
  if (spec.effect == "presliding_hysteresis") {
    return std::make_unique<PreslidingHysteresis>(spec, dof());
  }
  if (spec.effect == "hysteretic_stiffness") {
    return std::make_unique<HystereticStiffness>(spec, FindJoint(model, spec));
  }
  return nullptr;
}

}  // namespace mjdiag
