#include "mjdiag/plugin/effects/structure/late_dampers.h"

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

class LateDampersEffect final : public Effect {
 public:
  LateDampersEffect()
      : Effect({.name = "late_dampers",
                .family = Family::kStructure,
                .kind = Kind::kDelay,
                .form = Form::kAttributes,
                .variable = LawVariable::kAcceleration,
                .parameters = {NotNegative("delay", Role::kTime, "s")},
                .meaning = "the dampers of all joints act that much later"}) {}

  // Of every joint, whichever it is placed at.
  void Apply(mjModel& model, int, const EffectValues& values) const override {
    for (int dof = 0; dof < model.nv; ++dof) {
      const double lighter = values[0] * model.dof_damping[dof];
      if (lighter < 0.5 * model.dof_M0[dof]) model.dof_armature[dof] -= lighter;
    }
    const DataPtr data = MakeData(model);
    mj_setConst(&model, data.get());
  }
  Sized Draw(const Scales&, Random&) const override { return {}; }
};

}  // namespace

std::optional<PlacedEffect> LateDampers(const mjModel& plant, double delay) {
  static const LateDampersEffect effect;
  for (int joint = 0; joint < plant.njnt; ++joint) {
    const char* name = mj_id2name(&plant, mjOBJ_JOINT, joint);
    if (name != nullptr && *name != '\0') {
      return PlacedEffect{Lasting(effect), name, ValuesOf({delay})};
    }
  }
  return std::nullopt;
}

}  // namespace mjdiag
