// Dry friction that grows with what a drive transmits, and more so where it is slow:
//   F = (coefficient + breakaway exp(-(v / velocity)^2)) |motor - rest|
// with motor and rest as load_friction has them (drive_load.h), as the bound of MuJoCo's
// own friction constraint. [Duclusaud 2024]

#include <cmath>

#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/friction/stribeck_curve.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class FallingLoadBound final : public VaryingBound {
 public:
  FallingLoadBound(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof),
        coefficient_(values[0]),
        breakaway_(values[1]),
        velocity_(values[2]) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    const DriveLoad load = DriveLoadOf(model, data, dof());
    const double share = StribeckShare(data.qvel[dof()], velocity_);
    return (coefficient_ + breakaway_ * share) * std::abs(load.motor - load.rest);
  }

  double coefficient_;
  double breakaway_;
  double velocity_;
};

class StribeckLoadFrictionEffect final
    : public VaryingFrictionEffect<FallingLoadBound> {
 public:
  StribeckLoadFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "stribeck_load_friction",
             .family = Family::kFriction,
             .kind = Kind::kLoadFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("coefficient", Role::kAmplitude, "1"),
                            NotNegative("breakaway", Role::kAmplitude, "1"),
                            Positive("velocity", Role::kVelocity, "m/s")},
             .meaning = "dry friction of (coefficient + breakaway exp(-(v / "
                        "velocity)^2)) |what the drive transmits|",
             .odds = kSome}) {}

  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const ObservedLoad load(at);
    const Eigen::VectorXd bound = (load.motor - load.rest).cwiseAbs();
    return StribeckRegressors(at, -bound.cwiseProduct(Direction(at.v())));
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(LoadFriction()), self.site, self.values.head(1)};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double share = r.Uniform(0.2, 1.0);
    const double velocity = k.speed * r.Log(0.01, 0.2);
    return [=](double s) { return ValuesOf({0.2 * s * share, 0.2 * s, velocity}); };
  }
};

}  // namespace

const Effect& StribeckLoadFriction() {
  static const StribeckLoadFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
