// The force of the motor times factor.

#include <algorithm>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

class MotorConstantEffect final : public Effect {
 public:
  MotorConstantEffect()
      : Effect({.name = "motor_constant",
                .family = Family::kDrive,
                .kind = Kind::kDriveGain,
                .site = SiteKind::kActuator,
                .form = Form::kAttributes,
                .variable = LawVariable::kInput,
                .parameters = {NotNegative("factor", Role::kFactor, "1")},
                .meaning = "the force of the motor times factor"}) {}

  void Apply(mjModel& model, int actuator, const EffectValues& values) const override {
    mjtNum* gear = RowOf(model.actuator_gear, 6, actuator);
    std::for_each(gear, gear + 6, [&](mjtNum& g) { g *= values[0]; });
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(at.u(), at.MotorEntry(), 1.0, true)};
  }
  std::optional<ModelParameter> Number(const mjModel&, int actuator) const override {
    return ModelParameter{ModelParameterKind::kGear, actuator};
  }
  EffectValues Spread(const Scales&) const override { return ValuesOf({0.3}); }
  Sized Draw(const Scales&, Random& r) const override {
    return AroundOne(r.Sign() * 0.3);
  }
};

}  // namespace

const Effect& MotorConstant() {
  static const MotorConstantEffect effect;
  return effect;
}

}  // namespace mjdiag
