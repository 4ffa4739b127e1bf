// Dry friction: -force sign(v), sticking at rest.

#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class CoulombFrictionEffect final : public ConstantFrictionEffect {
 public:
  CoulombFrictionEffect()
      : ConstantFrictionEffect(
            {.name = "coulomb_friction",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .form = Form::kAttributes,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("force", Role::kAmplitude, "N")},
             .meaning = "dry friction: -force sign(v), sticking at rest"}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    AddDryFriction(model, joint, values[0]);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(-Direction(at.v()), at.JointEntry(), 0.0, true)};
  }
};

}  // namespace

const Effect& CoulombFriction() {
  static const CoulombFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
