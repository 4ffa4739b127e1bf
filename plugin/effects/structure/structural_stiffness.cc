// The stiffness of a joint that has one, times factor; its springref stays.

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/effects/structure/joint_spring.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

class StructuralStiffnessEffect final : public Effect {
 public:
  StructuralStiffnessEffect()
      : Effect({.name = "structural_stiffness",
                .family = Family::kStructure,
                .kind = Kind::kCompliance,
                .site = SiteKind::kHeldJoint,
                .form = Form::kAttributes,
                .variable = LawVariable::kPosition,
                .parameters = {NotNegative("factor", Role::kFactor, "1")},
                .meaning = "the stiffness of a joint that has one, times factor"}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    model.jnt_stiffness[joint] *= values[0];
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const auto [stiffness, strain] = JointSpring(at);
    std::vector<CandidateRegressor> trials = {
        LinearRegressor(-stiffness * strain, at.JointEntry(), 1.0, true)};
    // A spring that is much softer or stiffer moves a resonance away from where the
    // motion of the present plant has it: that is no first order.
    for (const double factor : LogGrid(0.4, 2.5, 16)) {
      Eigen::VectorXd moved;
      try {
        moved = MotionWithSpring(at.model, at.site.joint, (factor - 1.0) * stiffness,
                                 strain, at.motion.sample_time, at.plant.opt.timestep);
      } catch (const NumericalError&) {
        continue;
      }
      trials.push_back({-stiffness * moved, at.JointEntry(),
                        [factor](const Amplitudes& a) -> RegressorValues {
                          if (a[0] * (factor - 1.0) <= 0.0) return std::nullopt;
                          return ValuesOf({factor});
                        }});
    }
    return trials;
  }
  std::optional<ModelParameter> Number(const mjModel&, int joint) const override {
    return ModelParameter{ModelParameterKind::kStiffness, joint};
  }
  EffectValues Spread(const Scales&) const override { return ValuesOf({0.5}); }
  Sized Draw(const Scales&, Random& r) const override {
    return AroundOne(r.Sign() * 0.5);
  }
};

}  // namespace

const Effect& StructuralStiffness() {
  static const StructuralStiffnessEffect effect;
  return effect;
}

}  // namespace mjdiag
