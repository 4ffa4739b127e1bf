// Dry friction of a loaded gear:
//   F = |motor_share motor - load_share rest| + quadratic (motor - rest)^2
// It tells which side the load comes from, and teeth press harder and on more of their
// faces. motor and rest as load_friction has them
// (drive_load.h), as the bound of MuJoCo's own friction constraint. [Duclusaud 2024]

#include <cmath>

#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class GearBound final : public VaryingBound {
 public:
  GearBound(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof),
        motor_share_(values[0]),
        load_share_(values[1]),
        quadratic_(values[2]) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    const DriveLoad load = DriveLoadOf(model, data, dof());
    const double transmitted = load.motor - load.rest;
    return std::abs(motor_share_ * load.motor - load_share_ * load.rest) +
           quadratic_ * transmitted * transmitted;
  }

  double motor_share_;
  double load_share_;
  double quadratic_;
};

class GearLoadFrictionEffect final : public VaryingFrictionEffect<GearBound> {
 public:
  GearLoadFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "gear_load_friction",
             .family = Family::kFriction,
             .kind = Kind::kLoadFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("motor_share", Role::kAmplitude, "1"),
                            NotNegative("load_share", Role::kAmplitude, "1"),
                            NotNegative("quadratic", Role::kAmplitude, "1/N")},
             .meaning = "dry friction of |motor_share motor - load_share rest| + "
                        "quadratic (what the drive transmits)^2",
             .odds = kSome}) {}

  // Motor and rest work against each other nearly all the time, and what is taken of
  // both is the sum of two parts then.
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const ObservedLoad load(at);
    const Eigen::VectorXd s = -Direction(at.v());
    Eigen::MatrixXd parts(s.size(), 3);
    parts.col(0) = load.motor.cwiseAbs().cwiseProduct(s);
    parts.col(1) = load.rest.cwiseAbs().cwiseProduct(s);
    parts.col(2) = (load.motor - load.rest).cwiseAbs2().cwiseProduct(s);
    return {LinearRegressor(parts, at.JointEntry(3), 0.0, true)};
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(DirectionalLoadFriction()), self.site,
                        self.values.head(2)};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double share = r.Uniform(0.1, 0.9);
    return [=, force = k.force](double s) {
      return ValuesOf({0.3 * s * share, 0.3 * s * (1.0 - share), 0.05 * s / force});
    };
  }
};

}  // namespace

const Effect& GearLoadFriction() {
  static const GearLoadFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
