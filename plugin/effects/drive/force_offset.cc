// A constant force.

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class ForceOffsetEffect final : public JointForceEffect {
 public:
  ForceOffsetEffect()
      : JointForceEffect({.name = "force_offset",
                          .family = Family::kDrive,
                          .kind = Kind::kConstantForce,
                          .variable = LawVariable::kTime,
                          .parameters = {Free("force", Role::kAmplitude, "N")},
                          .meaning = "a constant force"}) {}

  double Force(double, double, double,
               const EffectValues& values) const noexcept override {
    return values[0];
  }
  std::optional<double> Law(double, const EffectValues& values) const override {
    return values[0];
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {
        LinearRegressor(Eigen::VectorXd::Ones(at.motion.samples()), at.JointEntry())};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    return Proportional(r.Sign() * 0.3 * k.FrictionForce());
  }
};

}  // namespace

const Effect& ForceOffset() {
  static const ForceOffsetEffect effect;
  return effect;
}

}  // namespace mjdiag
