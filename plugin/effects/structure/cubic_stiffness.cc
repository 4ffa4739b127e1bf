// -coefficient q^3, a force of the position alone: it stores, and takes nothing.

#include <cmath>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class CubicStiffnessEffect final : public JointForceEffect {
 public:
  CubicStiffnessEffect()
      : JointForceEffect(
            {.name = "cubic_stiffness",
             .family = Family::kStructure,
             .kind = Kind::kCompliance,
             .variable = LawVariable::kPosition,
             .parameters = {Free("coefficient", Role::kAmplitude, "N/m^3")},
             .meaning = "-coefficient q^3",
             .odds = kSome}) {}

  double Force(double q, double, double,
               const EffectValues& values) const noexcept override {
    return -values[0] * q * q * q;
  }
  // Nothing that is no spring softens.
  double Least(const mjModel& plant, Eigen::Index joint, std::size_t) const override {
    return plant.jnt_stiffness[plant.dof_jntid[joint]] > 0.0 ? -kAnySize : 0.0;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(-at.q().array().cube().matrix(), at.JointEntry())};
  }
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(k.FrictionForce() / std::pow(k.stroke, 3));
  }
};

}  // namespace

const Effect& CubicStiffness() {
  static const CubicStiffnessEffect effect;
  return effect;
}

}  // namespace mjdiag
