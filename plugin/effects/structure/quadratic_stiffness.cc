// -coefficient q^2: softer on one side, stiffer on the other, as a beam bent beforehand or
// the asymmetric well of Helmholtz' oscillator. Without a modulus: -q |q| would be as stiff
// on both sides, which cubic_stiffness is.

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class QuadraticStiffnessEffect final : public JointForceEffect {
 public:
  QuadraticStiffnessEffect()
      : JointForceEffect(
            {.name = "quadratic_stiffness",
             .family = Family::kStructure,
             .kind = Kind::kCompliance,
             .variable = LawVariable::kPosition,
             .parameters = {Free("coefficient", Role::kAmplitude, "N/m^2")},
             .meaning = "-coefficient q^2",
             .odds = kSome}) {}

  double Force(double q, double, double,
               const EffectValues& values) const noexcept override {
    return -values[0] * q * q;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(-at.q().array().square().matrix(), at.JointEntry())};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    return Proportional(r.Sign() * k.FrictionForce() / (k.stroke * k.stroke));
  }
};

}  // namespace

const Effect& QuadraticStiffness() {
  static const QuadraticStiffnessEffect effect;
  return effect;
}

}  // namespace mjdiag
