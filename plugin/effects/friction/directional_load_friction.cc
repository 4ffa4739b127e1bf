// Dry friction of a drive that tells which side the load comes from:
//   F = |motor_share motor - load_share rest|
// with motor and rest as load_friction has them (drive_load.h), as the bound of MuJoCo's
// own friction constraint. Where the two balance it is (motor_share + load_share) |motor|;
// a worm gear, which a load cannot turn back, has a large load_share. [Duclusaud 2024]

#include <cmath>

#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class BoundBySide final : public VaryingBound {
 public:
  BoundBySide(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof), motor_share_(values[0]), load_share_(values[1]) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    const DriveLoad load = DriveLoadOf(model, data, dof());
    return std::abs(motor_share_ * load.motor - load_share_ * load.rest);
  }

  double motor_share_;
  double load_share_;
};

class DirectionalLoadFrictionEffect final : public VaryingFrictionEffect<BoundBySide> {
 public:
  DirectionalLoadFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "directional_load_friction",
             .family = Family::kFriction,
             .kind = Kind::kLoadFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("motor_share", Role::kAmplitude, "1"),
                            NotNegative("load_share", Role::kAmplitude, "1")},
             .meaning = "dry friction of |motor_share motor - load_share rest|: a "
                        "drive that a load turns less easily than its motor",
             .odds = kSome}) {}

  // Motor and rest work against each other nearly all the time, and the bound is the sum
  // of its two parts then.
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const ObservedLoad load(at);
    const Eigen::VectorXd s = Direction(at.v());
    Eigen::MatrixXd parts(s.size(), 2);
    parts.col(0) = -load.motor.cwiseAbs().cwiseProduct(s);
    parts.col(1) = -load.rest.cwiseAbs().cwiseProduct(s);
    return {LinearRegressor(parts, at.JointEntry(2), 0.0, true)};
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(LoadFriction()), self.site,
                        ValuesOf({0.5 * self.values.sum()})};
  }
  Sized Draw(const Scales&, Random& r) const override {
    const double share = r.Uniform(0.1, 0.9);
    return [=](double s) {
      return ValuesOf({0.4 * s * share, 0.4 * s * (1.0 - share)});
    };
  }
};

}  // namespace

const Effect& DirectionalLoadFriction() {
  static const DirectionalLoadFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
