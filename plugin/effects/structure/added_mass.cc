// Mass at the centre of the body that a slide moves; inertia about a hinge.

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

class AddedMassEffect final : public Effect {
 public:
  AddedMassEffect()
      : Effect({.name = "added_mass",
                .family = Family::kStructure,
                .kind = Kind::kInertia,
                .form = Form::kAttributes,
                .variable = LawVariable::kAcceleration,
                .parameters = {Free("mass", Role::kAmplitude, "kg")},
                .meaning =
                    "mass at the centre of the moving body; inertia about a hinge"}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    const double mass = values[0];
    if (model.jnt_type[joint] == mjJNT_HINGE) {
      const int dof = model.jnt_dofadr[joint];
      // dof_M0 is the inertia at qpos0, armature included.
      if (model.dof_M0[dof] + mass <= 0.0) FailTooMuch(*this, model, joint, "inertia");
      model.dof_armature[dof] += mass;
    } else {
      mjtNum& body = model.body_mass[model.jnt_bodyid[joint]];
      if (body + mass <= 0.0) FailTooMuch(*this, model, joint, "mass");
      body += mass;
    }
    // What MuJoCo derives from masses when it compiles.
    const DataPtr data = MakeData(model);
    mj_setConst(&model, data.get());
  }
  double Least(const mjModel& plant, Eigen::Index dof, std::size_t) const override {
    const int joint = plant.dof_jntid[dof];
    const double mass = plant.jnt_type[joint] == mjJNT_HINGE
                            ? plant.dof_M0[dof]
                            : plant.body_mass[plant.jnt_bodyid[joint]];
    return -0.9 * mass;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(-at.own_a(), at.JointEntry())};
  }
  std::optional<double> Law(double a, const EffectValues& values) const override {
    return -values[0] * a;
  }
  std::optional<ModelParameter> Number(const mjModel& model, int joint) const override {
    if (model.jnt_type[joint] == mjJNT_HINGE) return std::nullopt;
    return ModelParameter{ModelParameterKind::kMass, model.jnt_bodyid[joint]};
  }
  EffectValues Spread(const Scales& k) const override {
    return ValuesOf({0.5 * k.mass});
  }
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(0.3 * k.mass);
  }
};

}  // namespace

const Effect& AddedMass() {
  static const AddedMassEffect effect;
  return effect;
}

}  // namespace mjdiag
