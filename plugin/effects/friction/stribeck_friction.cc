// Dry friction whose bound falls with speed:
//   F = coulomb + breakaway exp(-(v / velocity)^2)
// as the bound of MuJoCo's own friction constraint, so that it sticks exactly. The
// constant part is in the model; the part that falls with speed is added in every step.

#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/friction/stribeck_curve.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class FallingBound final : public VaryingBound {
 public:
  FallingBound(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof), breakaway_(values[1]), velocity_(values[2]) {}

 private:
  double Added(const mjModel&, mjData& data) noexcept override {
    return breakaway_ * StribeckShare(data.qvel[dof()], velocity_);
  }

  double breakaway_;
  double velocity_;
};

class StribeckFrictionEffect final : public VaryingFrictionEffect<FallingBound> {
 public:
  StribeckFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "stribeck_friction",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("coulomb", Role::kAmplitude, "N"),
                            NotNegative("breakaway", Role::kAmplitude, "N"),
                            Positive("velocity", Role::kVelocity, "m/s")},
             .meaning = "dry friction of coulomb + breakaway exp(-(v / velocity)^2)"}) {
  }

  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return StribeckRegressors(at, -Direction(at.v()));
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(CoulombFriction()), self.site, self.values.head(1)};
  }
  std::optional<ModelParameter> Number(const mjModel&, int joint) const override {
    return ModelParameter{ModelParameterKind::kFriction, joint};
  }
  std::optional<double> Law(double v, const EffectValues& values) const override {
    return -Sign(v) * (values[0] + values[1] * StribeckShare(v, values[2]));
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double force = k.FrictionForce();
    const double share = r.Uniform(0.2, 1.0);
    const double velocity = k.speed * r.Log(0.01, 0.2);
    return [=](double s) { return ValuesOf({s * share * force, s * force, velocity}); };
  }

 private:
  double Constant(const EffectValues& values) const override { return values[0]; }
};

}  // namespace

const Effect& StribeckFriction() {
  static const StribeckFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
