// Friction laws of outside_law.h.

#include <cmath>
#include <memory>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/wave.h"
#include "mjdiag/studies/outside_law.h"

namespace mjdiag {
namespace {

class Contact final : public ActiveEffect {
 public:
  Contact(int dof, const EffectValues& values)
      : force_(values[0]),
        rate_(values[1]),
        state_(values[2]),
        velocity_(values[3]),
        length_(values[4]),
        age_(length_ / velocity_),
        dof_(dof) {}

  // Over a step v is constant and the age goes to L / |v| on an exponential.
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double v = data.qvel[dof_];
    const double turns = std::abs(v) * model.opt.timestep / length_;
    // (1 - exp(-turns)) / turns h, also where it rests.
    const double healed =
        turns > 0.0 ? -std::expm1(-turns) * length_ / std::abs(v) : model.opt.timestep;
    age_ = age_ * std::exp(-turns) + healed;
    const double holds = 1.0 + state_ * std::log(velocity_ * age_ / length_);
    const double ratio = 0.5 * std::abs(v) / velocity_;
    const double slides = std::asinh(ratio * std::exp(holds / rate_));
    data.qfrc_applied[dof_] -= std::copysign(force_ * rate_ * slides, v);
  }

 private:
  double force_;
  double rate_;
  double state_;
  double velocity_;
  double length_;
  double age_;  // [s]
  int dof_;
};

class RateAndStateFrictionLaw final : public Effect {
 public:
  RateAndStateFrictionLaw()
      : Effect({.name = "rate_and_state_friction",
                .family = Family::kFriction,
                .kind = Kind::kDryFriction,
                .variable = LawVariable::kVelocity,
                .parameters = {NotNegative("force", Role::kAmplitude, "N"),
                               Positive("rate", Role::kRatio, "1"),
                               NotNegative("state", Role::kRatio, "1"),
                               Positive("velocity", Role::kVelocity, "m/s"),
                               Positive("length", Role::kLength, "m")},
                .meaning = "friction of a contact that heals while it rests"}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<Contact>(model.jnt_dofadr[joint], values);
  }
  // It weakens with speed where state is larger than rate. Contacts of rock have a tenth
  // of both, and change their force with a velocity that no time step resolves.
  Sized Draw(const Scales& k, Random& r) const override {
    const double rate = r.Uniform(0.1, 0.2);
    const double state = rate * r.Uniform(1.2, 2.0);
    const double velocity = k.speed * r.Log(0.05, 0.3);
    const double length = k.stroke * r.Log(3e-3, 0.05);
    return [=, force = k.FrictionForce()](double s) {
      return ValuesOf({s * force, rate, state, velocity, length});
    };
  }
};

class RootFrictionLaw final : public JointForceEffect {
 public:
  RootFrictionLaw()
      : JointForceEffect({.name = "root_friction",
                          .family = Family::kFriction,
                          .kind = Kind::kViscousFriction,
                          .variable = LawVariable::kVelocity,
                          .parameters = {NotNegative("force", Role::kAmplitude, "N"),
                                         Positive("velocity", Role::kVelocity, "m/s")},
                          .meaning = "-force sign(v) sqrt(|v| / velocity)"}) {}

  // Below a thousandth of the velocity in proportion, so that it has a slope.
  double Force(double, double v, double,
               const EffectValues& values) const noexcept override {
    constexpr double kSlow = 1e-3;
    const double ratio = v / values[1];
    return -values[0] * ratio / std::pow(ratio * ratio + kSlow * kSlow, 0.25);
  }
  Sized Draw(const Scales& k, Random&) const override {
    return [force = k.FrictionForce(), velocity = k.speed](double s) {
      return ValuesOf({s * force, velocity});
    };
  }
};

class FreshSurface final : public ActiveEffect {
 public:
  FreshSurface(int dof, const EffectValues& values) : values_(values), dof_(dof) {}

  void Push(const mjModel& model, mjData& data) noexcept override {
    const double v = data.qvel[dof_];
    const double slow = values_[3];
    // What only trembles has not turned.
    if (std::abs(v) > slow && (v > 0.0) != forwards_) {
      forwards_ = v > 0.0;
      travel_ = 0.0;
    }
    travel_ += std::abs(v) * model.opt.timestep;
    const double more = values_[1] * std::exp(-travel_ / values_[2]);
    data.qfrc_applied[dof_] -= values_[0] * (1.0 + more) * std::tanh(v / slow);
  }

 private:
  EffectValues values_;
  double travel_ = 0.0;  // [m], since it turned
  bool forwards_ = true;
  int dof_;
};

class ReversalFrictionLaw final : public Effect {
 public:
  ReversalFrictionLaw()
      : Effect({.name = "reversal_friction",
                .family = Family::kFriction,
                .kind = Kind::kDryFriction,
                .variable = LawVariable::kVelocity,
                .parameters = {NotNegative("force", Role::kAmplitude, "N"),
                               NotNegative("fresh", Role::kRatio, "1"),
                               Positive("length", Role::kLength, "m"),
                               Positive("velocity", Role::kVelocity, "m/s")},
                .meaning = "friction that falls with the travel since it turned"}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<FreshSurface>(model.jnt_dofadr[joint], values);
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double fresh = r.Uniform(0.5, 2.0);
    const double length = k.stroke * r.Log(0.05, 0.3);
    return [=, force = k.FrictionForce(), slow = 0.02 * k.speed](double s) {
      return ValuesOf({s * force, fresh, length, slow});
    };
  }
};

class PeriodicDampingLaw final : public JointForceEffect {
 public:
  PeriodicDampingLaw()
      : JointForceEffect(
            {.name = "periodic_damping",
             .family = Family::kFriction,
             .kind = Kind::kViscousFriction,
             .variable = LawVariable::kPosition,
             .parameters = {NotNegative("coefficient", Role::kAmplitude, "N s/m"),
                            NotNegative("share", Role::kRatio, "1"),
                            Positive("first", Role::kPeriod, "m"),
                            Positive("second", Role::kPeriod, "m")},
             .meaning = "damping with two periods along the stroke"}) {}

  double Force(double q, double v, double,
               const EffectValues& values) const noexcept override {
    const double pattern = values[1] * std::sin(kTurn * q / values[2]) +
                           (1.0 - values[1]) * std::sin(kTurn * q / values[3]);
    return -values[0] * (1.0 + pattern) * v;
  }
  // Of two variables.
  std::optional<double> Law(double, const EffectValues&) const override {
    return std::nullopt;
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double share = r.Uniform(0.3, 0.7);
    const double first = k.stroke * r.Log(0.1, 0.4);
    const double second = first * r.Uniform(0.2, 0.7);
    return [=, coefficient = k.FrictionForce() / k.speed](double s) {
      return ValuesOf({s * coefficient, share, first, second});
    };
  }
};

}  // namespace

const Effect& RateAndStateFriction() {
  static const RateAndStateFrictionLaw law;
  return law;
}

const Effect& RootFriction() {
  static const RootFrictionLaw law;
  return law;
}

const Effect& ReversalFriction() {
  static const ReversalFrictionLaw law;
  return law;
}

const Effect& PeriodicDamping() {
  static const PeriodicDampingLaw law;
  return law;
}

}  // namespace mjdiag
