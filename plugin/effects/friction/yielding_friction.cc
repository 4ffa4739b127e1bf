// Dry friction as a simulation has it whose author left solreffriction and solimpfriction as they
// are: a joint that stands gives way, by the speed that what pushes it makes in a millisecond.

#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class YieldingFrictionEffect final : public ConstantFrictionEffect {
 public:
  YieldingFrictionEffect()
      : ConstantFrictionEffect(
            {.name = "yielding_friction",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .form = Form::kAttributes,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("force", Role::kAmplitude, "N")},
             .meaning = "dry friction: -force sign(v), giving way at rest as MuJoCo's "
                        "does by default",
             .odds = kLearned}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    model.dof_frictionloss[model.jnt_dofadr[joint]] += values[0];
  }
  /// Where the model has parameters of its own it is coulomb_friction.
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    std::vector<Site> sites = Effect::CandidateSites(map);
    std::erase_if(sites, [&](const Site& site) {
      return HasOwnFrictionSolver(map.plant(), static_cast<int>(site.joint));
    });
    return sites;
  }
};

}  // namespace

const Effect& YieldingFriction() {
  static const YieldingFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
