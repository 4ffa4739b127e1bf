// -coefficient v

#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class ViscousFrictionEffect final : public Effect {
 public:
  ViscousFrictionEffect()
      : Effect({.name = "viscous_friction",
                .family = Family::kFriction,
                .kind = Kind::kViscousFriction,
                .form = Form::kAttributes,
                .variable = LawVariable::kVelocity,
                .parameters = {Free("coefficient", Role::kAmplitude, "N s/m")},
                .meaning = "-coefficient v"}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    mjtNum& damping = model.dof_damping[model.jnt_dofadr[joint]];
    damping += values[0];
    if (damping < 0.0) FailTooMuch(*this, model, joint, "damping");
  }
  double Least(const mjModel& plant, Eigen::Index joint, std::size_t) const override {
    return -plant.dof_damping[joint];
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(-at.v(), at.JointEntry())};
  }
  std::optional<ModelParameter> Number(const mjModel&, int joint) const override {
    return ModelParameter{ModelParameterKind::kDamping, joint};
  }
  std::optional<double> Law(double v, const EffectValues& values) const override {
    return -values[0] * v;
  }
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(k.FrictionForce() / k.speed);
  }
};

}  // namespace

const Effect& ViscousFriction() {
  static const ViscousFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
