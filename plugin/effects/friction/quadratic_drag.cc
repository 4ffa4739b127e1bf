// -coefficient v |v|, which takes coefficient |v|^3 of power. Nothing that a plant has of
// its own grows with the square of the velocity: what is taken off a damper D would drive
// the joint beyond D / |coefficient|.

#include <cmath>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class QuadraticDragEffect final : public JointForceEffect {
 public:
  QuadraticDragEffect()
      : JointForceEffect(
            {.name = "quadratic_drag",
             .family = Family::kFriction,
             .kind = Kind::kViscousFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("coefficient", Role::kAmplitude, "N s^2/m^2")},
             .meaning = "-coefficient v |v|",
             .odds = kSome}) {}

  double Force(double, double v, double,
               const EffectValues& values) const noexcept override {
    return -values[0] * v * std::abs(v);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(-at.v().cwiseProduct(at.v().cwiseAbs()), at.JointEntry(),
                            0.0, true)};
  }
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(k.FrictionForce() / (k.speed * k.speed));
  }
};

}  // namespace

const Effect& QuadraticDrag() {
  static const QuadraticDragEffect effect;
  return effect;
}

}  // namespace mjdiag
