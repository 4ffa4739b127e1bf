// Dry friction of a loaded gear, with all that is known of it in one law:
//   F = |motor_share motor - load_share rest| (1 + breakaway exp(-(v / velocity)^2))
//       + quadratic (motor - rest)^2
// which side the load comes from, how much more it takes to set it going, and teeth that
// press harder and on more of their faces. motor and rest as load_friction has them
// (drive_load.h), as the bound of MuJoCo's own friction constraint. [Duclusaud 2024]

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/friction/stribeck_curve.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/trial_signals.h"

namespace mjdiag {
namespace {

class GearBound final : public VaryingBound {
 public:
  GearBound(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof),
        motor_share_(values[0]),
        load_share_(values[1]),
        breakaway_(values[2]),
        velocity_(values[3]),
        quadratic_(values[4]) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    const DriveLoad load = DriveLoadOf(model, data, dof());
    const double slow = breakaway_ * StribeckShare(data.qvel[dof()], velocity_);
    const double transmitted = load.motor - load.rest;
    return (1.0 + slow) *
               std::abs(motor_share_ * load.motor - load_share_ * load.rest) +
           quadratic_ * transmitted * transmitted;
  }

  double motor_share_;
  double load_share_;
  double breakaway_;
  double velocity_;
  double quadratic_;
};

class GearFrictionEffect final : public VaryingFrictionEffect<GearBound> {
 public:
  GearFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "gear_friction",
             .family = Family::kFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("motor_share", Role::kAmplitude, "1"),
                            NotNegative("load_share", Role::kAmplitude, "1"),
                            NotNegative("breakaway", Role::kAmplitude, "1"),
                            Positive("velocity", Role::kVelocity, "m/s"),
                            NotNegative("quadratic", Role::kAmplitude, "1/N")},
             .meaning = "dry friction of |motor_share motor - load_share rest| (1 + "
                        "breakaway exp(-(v / velocity)^2)) + quadratic (what the "
                        "drive transmits)^2",
             .odds = kSome}) {}

  // Motor and rest work against each other nearly all the time, and what is taken of
  // both is the sum of two parts then.
  std::vector<Trial> Trials(const SiteMotion& at) const override {
    const ObservedLoad load(at);
    const Eigen::VectorXd v = at.v();
    const Eigen::ArrayXd s = -Direction(v).array();
    const Eigen::ArrayXd transmitted = load.motor - load.rest;
    std::vector<Trial> trials;
    for (const double velocity :
         LogGrid(0.01 * v.cwiseAbs().maxCoeff(), 0.6 * v.cwiseAbs().maxCoeff(), 5)) {
      Eigen::MatrixXd parts(v.size(), 4);
      parts.col(0) = load.motor.array().abs() * s;
      parts.col(1) = load.rest.array().abs() * s;
      parts.col(2) = transmitted.abs() * (-(v.array() / velocity).square()).exp() * s;
      parts.col(3) = transmitted.square() * s;
      trials.push_back({parts, at.JointEntry(4), [velocity](const Amplitudes& a) {
                          return ValuesFor(a, velocity);
                        }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(DirectionalLoadFriction()), self.site,
                        self.values.head(2)};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double share = r.Uniform(0.1, 0.9);
    const double breakaway = r.Uniform(0.2, 1.0);
    const double velocity = k.speed * r.Log(0.01, 0.2);
    return [=, force = k.force](double s) {
      return ValuesOf({0.3 * s * share, 0.3 * s * (1.0 - share), breakaway, velocity,
                       0.05 * s / force});
    };
  }

 private:
  static TrialValues ValuesFor(const Amplitudes& a, double velocity) {
    const double both = 0.5 * (a[0] + a[1]);
    if (both <= 0.0) return std::nullopt;
    return ValuesOf({std::max(a[0], 0.0), std::max(a[1], 0.0),
                     std::max(a[2] / both, 0.0), velocity, std::max(a[3], 0.0)});
  }
};

}  // namespace

const Effect& GearFriction() {
  static const GearFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
