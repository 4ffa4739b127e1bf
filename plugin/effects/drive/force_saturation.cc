// The drive gives no more than that, before the gear.

#include <algorithm>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

class ForceSaturationEffect final : public Effect {
 public:
  ForceSaturationEffect()
      : Effect({.name = "force_saturation",
                .family = Family::kDrive,
                .kind = Kind::kDriveLimit,
                .site = SiteKind::kActuator,
                .form = Form::kAttributes,
                .variable = LawVariable::kInput,
                .parameters = {Positive("limit", Role::kLimit, "of u")},
                .meaning = "the drive gives no more than that"}) {}

  void Apply(mjModel& model, int actuator, const EffectValues& values) const override {
    mjtNum* range = RowOf(model.actuator_forcerange, 2, actuator);
    const double limit = values[0];
    const bool limited = model.actuator_forcelimited[actuator] != 0;
    range[0] = limited ? std::max(range[0], -limit) : -limit;
    range[1] = limited ? std::min(range[1], limit) : limit;
    model.actuator_forcelimited[actuator] = 1;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd f = at.before_gear();
    const double top = f.cwiseAbs().maxCoeff();
    const double gain =
        MotorGain(at.plant, FindElement(at.plant, mjOBJ_ACTUATOR, at.site.name));
    if (gain == 0.0) return {};
    std::vector<CandidateRegressor> trials;
    // The last of them cut off the very peaks.
    for (const double cut : {0.7, 0.5, 0.35, 0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3,
                             1e-3, 5e-4, 2e-4, 1e-4}) {
      const double limit = (1.0 - cut) * top;
      trials.push_back({f.cwiseMax(-limit).cwiseMin(limit) - f, at.MotorEntry() / gain,
                        [limit](const Amplitudes& a) -> RegressorValues {
                          if (a[0] <= 0.0) return std::nullopt;
                          return ValuesOf({limit});
                        }});
    }
    return trials;
  }
  Sized Draw(const Scales& k, Random&) const override {
    return [force = k.force](double s) { return ValuesOf({force * (1.0 - 0.5 * s)}); };
  }
};

}  // namespace

const Effect& ForceSaturation() {
  static const ForceSaturationEffect effect;
  return effect;
}

}  // namespace mjdiag
