// Friction laws of outside_law.h.

#include <cmath>
#include <memory>

#include "mjdiag/plugin/effects/friction/stribeck_curve.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/wave.h"
#include "mjdiag/studies/outside_law.h"

namespace mjdiag {
namespace {

class Bristles final : public ActiveEffect {
 public:
  Bristles(int dof, const EffectValues& values) : values_(values), dof_(dof) {}

  // Over a step v is constant and z goes to its end on an exponential.
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double h = model.opt.timestep;
    const double v = data.qvel[dof_];
    const double slides = values_[0] + values_[1] * StribeckShare(v, values_[2]);
    if (slides <= 0.0) return;
    const double stiffness = values_[3];
    const double end = std::copysign(slides / stiffness, v);
    const double before = z_;
    z_ = end + (z_ - end) * std::exp(-stiffness * std::abs(v) * h / slides);
    data.qfrc_applied[dof_] -= stiffness * z_ + values_[4] * (z_ - before) / h;
  }

 private:
  EffectValues values_;
  double z_ = 0.0;  // [m]
  int dof_;
};

class LugreFrictionLaw final : public Effect {
 public:
  LugreFrictionLaw()
      : Effect({.name = "lugre_friction",
                .family = Family::kFriction,
                .variable = LawVariable::kVelocity,
                .parameters = {NotNegative("coulomb", Role::kAmplitude, "N"),
                               NotNegative("breakaway", Role::kAmplitude, "N"),
                               Positive("velocity", Role::kVelocity, "m/s"),
                               Positive("stiffness", Role::kSteepness, "N/m"),
                               NotNegative("damping", Role::kSteepness, "N s/m")},
                .meaning = "bristles that slide"}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<Bristles>(model.jnt_dofadr[joint], values);
  }
  // The bristles are as long as presliding of guides, and damped to a tenth of what they
  // are critically with the mass.
  Sized Draw(const Scales& k, Random& r) const override {
    const double force = k.SmallForce();
    const double length = k.stroke * r.Log(3e-3, 0.05);
    const double velocity = k.speed * r.Log(0.05, 0.3);
    const double mass = k.mass;
    return [=](double s) {
      const double stiffness = s * force / length;
      const double damping = 0.1 * 2.0 * std::sqrt(stiffness * mass);
      return ValuesOf({0.5 * s * force, 0.5 * s * force, velocity, stiffness, damping});
    };
  }
};

class RootFrictionLaw final : public JointForceEffect {
 public:
  RootFrictionLaw()
      : JointForceEffect({.name = "root_friction",
                          .family = Family::kFriction,
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
    return [force = k.SmallForce(), velocity = k.speed](double s) {
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
    return [=, force = k.SmallForce(), slow = 0.02 * k.speed](double s) {
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
    return [=, coefficient = k.SmallForce() / k.speed](double s) {
      return ValuesOf({s * coefficient, share, first, second});
    };
  }
};

}  // namespace

const Effect& LugreFriction() {
  static const LugreFrictionLaw law;
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
