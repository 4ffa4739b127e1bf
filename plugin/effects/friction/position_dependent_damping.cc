// -(slope q + curvature q^2) v, beside a damper D that is there, which takes power of
//   max(0, D + slope q + curvature q^2) v^2:
// where the polynomial would drive the joint, it is not damped at all.

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class PositionDependentDampingEffect final : public JointDampingEffect {
 public:
  PositionDependentDampingEffect()
      : JointDampingEffect(
            {.name = "position_dependent_damping",
             .family = Family::kFriction,
             .kind = Kind::kViscousFriction,
             .variable = LawVariable::kPosition,
             .parameters = {Free("slope", Role::kAmplitude, "N s/m^2"),
                            Free("curvature", Role::kAmplitude, "N s/m^3")},
             .meaning = "-(slope q + curvature q^2) v, beside the joint's damper",
             .odds = kRare}) {}

  double Damping(double q, double, const EffectValues& values) const noexcept override {
    return (values[0] + values[1] * q) * q;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    Eigen::MatrixXd parts(q.size(), 2);
    parts.col(0) = -q.cwiseProduct(at.v());
    parts.col(1) = parts.col(0).cwiseProduct(q);
    return {LinearRegressor(parts, at.JointEntry(2))};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double damping = k.FrictionForce() / k.speed;
    const double slope = r.Sign() * damping / k.stroke;
    const double curvature = r.Uniform(0.2, 1.0) * damping / (k.stroke * k.stroke);
    return [=](double s) { return ValuesOf({s * slope, s * curvature}); };
  }
};

}  // namespace

const Effect& PositionDependentDamping() {
  static const PositionDependentDampingEffect effect;
  return effect;
}

}  // namespace mjdiag
