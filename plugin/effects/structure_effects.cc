// Forces that come from the machine's structure and from outside. q: position of the
// joint from qpos0, v: its velocity.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/plugin/effects/effect_factory.h"

namespace mjdiag {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

class ForceOffset final : public ActiveEffect {
 public:
  ForceOffset(const EffectSpec& spec, int dof)
      : force_(spec.Value("force")), dof_(dof) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    data.qfrc_applied[dof_] += force_;
  }

 private:
  double force_;
  int dof_;
};

class ForceRipple final : public ActiveEffect {
 public:
  ForceRipple(const EffectSpec& spec, const JointOf& joint)
      : amplitude_(spec.Value("amplitude")),
        wave_number_(kTurn / spec.Value("period")),
        phase_(spec.Value("phase")),
        joint_(joint) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    const double q = data.qpos[joint_.position] - joint_.rest;
    data.qfrc_applied[joint_.dof] += amplitude_ * std::sin(wave_number_ * q + phase_);
  }

 private:
  double amplitude_;
  double wave_number_;
  double phase_;
  JointOf joint_;
};

class CubicStiffness final : public ActiveEffect {
 public:
  CubicStiffness(const EffectSpec& spec, const JointOf& joint)
      : coefficient_(spec.Value("coefficient")), joint_(joint) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    const double q = data.qpos[joint_.position] - joint_.rest;
    data.qfrc_applied[joint_.dof] -= coefficient_ * q * q * q;
  }

 private:
  double coefficient_;
  JointOf joint_;
};

/// A mass m on the joint by a spring and a damper, x its position:
///   m x'' = -f,  f = m (omega^2 (x - q) + 2 zeta omega (x' - v)),  f on the joint
/// integrated as MuJoCo's Euler does (velocity first).
class FlexibleMode final : public ActiveEffect {
 public:
  FlexibleMode(const EffectSpec& spec, const JointOf& joint)
      : mass_(spec.Value("mass")), joint_(joint) {
    const double omega = kTurn * spec.Value("frequency");
    stiffness_ = omega * omega;
    damping_ = 2.0 * spec.Value("damping_ratio") * omega;
  }
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double q = data.qpos[joint_.position];
    const double v = data.qvel[joint_.dof];
    if (!started_) {
      x_ = q;
      velocity_ = v;
      started_ = true;
    }
    const double pull = stiffness_ * (x_ - q) + damping_ * (velocity_ - v);
    data.qfrc_applied[joint_.dof] += mass_ * pull;
    velocity_ -= model.opt.timestep * pull;
    x_ += model.opt.timestep * velocity_;
  }

 private:
  double mass_;
  double stiffness_ = 0.0;
  double damping_ = 0.0;
  double x_ = 0.0;
  double velocity_ = 0.0;
  bool started_ = false;
  JointOf joint_;
};

/// The joint's spring does not act within gap / 2 of its rest: gives back what MuJoCo's
/// spring takes there.
class Backlash final : public ActiveEffect {
 public:
  Backlash(const mjModel& model, const EffectSpec& spec, const JointOf& joint)
      : half_gap_(0.5 * spec.Value("gap")),
        stiffness_(model.jnt_stiffness[model.dof_jntid[joint.dof]]),
        rest_(model.qpos_spring[joint.position]),
        joint_(joint) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    const double strain = data.qpos[joint_.position] - rest_;
    data.qfrc_applied[joint_.dof] +=
        stiffness_ * std::clamp(strain, -half_gap_, half_gap_);
  }

 private:
  double half_gap_;
  double stiffness_;
  double rest_;
  JointOf joint_;
};

class EndStop final : public ActiveEffect {
 public:
  EndStop(const EffectSpec& spec, const JointOf& joint)
      : position_(spec.Value("position")),
        stiffness_(spec.Value("stiffness")),
        joint_(joint) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    const double beyond = data.qpos[joint_.position] - joint_.rest - position_;
    const bool touches = position_ >= 0.0 ? beyond > 0.0 : beyond < 0.0;
    if (touches) data.qfrc_applied[joint_.dof] -= stiffness_ * beyond;
  }

 private:
  double position_;
  double stiffness_;
  JointOf joint_;
};

class FloorVibration final : public ActiveEffect {
 public:
  FloorVibration(const EffectSpec& spec, int dof)
      : amplitude_(spec.Value("amplitude")),
        omega_(kTurn * spec.Value("frequency")),
        phase_(spec.Value("phase")),
        dof_(dof) {}
  void Push(const mjModel&, mjData& data) noexcept override {
    data.qfrc_applied[dof_] += amplitude_ * std::sin(omega_ * data.time + phase_);
  }

 private:
  double amplitude_;
  double omega_;
  double phase_;
  int dof_;
};

}  // namespace

std::unique_ptr<ActiveEffect> MakeStructureEffect(const mjModel& model,
                                                  const EffectSpec& spec) {
  const auto joint = [&] { return FindJoint(model, spec); };
  if (spec.effect == "force_offset") {
    return std::make_unique<ForceOffset>(spec, joint().dof);
  }
  if (spec.effect == "force_ripple") {
    return std::make_unique<ForceRipple>(spec, joint());
  }
  if (spec.effect == "cubic_stiffness") {
    return std::make_unique<CubicStiffness>(spec, joint());
  }
  if (spec.effect == "flexible_mode") {
    return std::make_unique<FlexibleMode>(spec, joint());
  }
  if (spec.effect == "backlash") {
    return std::make_unique<Backlash>(model, spec, joint());
  }
  if (spec.effect == "end_stop") return std::make_unique<EndStop>(spec, joint());
  if (spec.effect == "floor_vibration") {
    return std::make_unique<FloorVibration>(spec, joint().dof);
  }
  return nullptr;
}

}  // namespace mjdiag
