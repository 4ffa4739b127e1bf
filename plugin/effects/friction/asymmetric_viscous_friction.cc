// -positive v for v > 0, -negative v for v < 0
// Beside the joint's damper D it takes (D + positive) v^2 or (D + negative) v^2 of power:
// passive where neither is below -D.

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class AsymmetricViscousFrictionEffect final : public JointDampingEffect {
 public:
  AsymmetricViscousFrictionEffect()
      : JointDampingEffect({.name = "asymmetric_viscous_friction",
                            .family = Family::kFriction,
                            .kind = Kind::kViscousFriction,
                            .variable = LawVariable::kVelocity,
                            .parameters = {Free("positive", Role::kAmplitude, "N s/m"),
                                           Free("negative", Role::kAmplitude, "N s/m")},
                            .meaning = "-positive v for v > 0, -negative v for v < 0",
                            .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels& channels,
                                         int joint,
                                         const EffectValues& values) const override {
    const double has = std::max(0.0, model.dof_damping[model.jnt_dofadr[joint]]);
    if (values.minCoeff() < -has) FailTooMuch(*this, model, joint, "damping");
    return JointDampingEffect::Activate(model, channels, joint, values);
  }
  double Damping(double, double v, const EffectValues& values) const noexcept override {
    return v > 0.0 ? values[0] : values[1];
  }
  double Least(const mjModel& plant, Eigen::Index joint, std::size_t) const override {
    return -std::max(0.0, plant.dof_damping[joint]);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd v = at.v();
    Eigen::MatrixXd sides(v.size(), 2);
    sides << -v.cwiseMax(0.0), -v.cwiseMin(0.0);
    CandidateRegressor trial = LinearRegressor(sides, at.JointEntry(2));
    trial.least =
        Amplitudes::Constant(2, -std::max(0.0, at.plant.dof_damping[at.site.joint]));
    return {std::move(trial)};
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(ViscousFriction()), self.site,
                        ValuesOf({(self.values[0] + self.values[1]) / 2.0})};
  }
  std::optional<ModelParameter> Number(const mjModel&, int joint) const override {
    return ModelParameter{ModelParameterKind::kDamping, joint};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double up = r.Uniform(0.2, 1.0) * k.FrictionForce() / k.speed;
    const double down = up * r.Uniform(1.5, 4.0);
    return [=](double s) { return ValuesOf({s * up, s * down}); };
  }
};

}  // namespace

const Effect& AsymmetricViscousFriction() {
  static const AsymmetricViscousFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
