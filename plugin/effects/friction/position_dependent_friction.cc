// Dry friction that changes along the stroke, as on guides that are not parallel or a
// screw of uneven preload:
//   F = F0 + slope q + curvature q^2, where that is positive
// with the friction F0 that the joint has otherwise, as the bound of MuJoCo's own friction
// constraint.

#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class BoundByPosition final : public VaryingBound {
 public:
  BoundByPosition(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof),
        joint_(joint),
        slope_(values[0]),
        curvature_(values[1]) {}

 private:
  double Added(const mjModel&, mjData& data) noexcept override {
    const double q = data.qpos[joint_.position] - joint_.rest;
    return (slope_ + curvature_ * q) * q;
  }

  JointOf joint_;
  double slope_;
  double curvature_;
};

class PositionDependentFrictionEffect final
    : public VaryingFrictionEffect<BoundByPosition> {
 public:
  PositionDependentFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "position_dependent_friction",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .variable = LawVariable::kPosition,
             .parameters = {Free("slope", Role::kAmplitude, "N/m"),
                            Free("curvature", Role::kAmplitude, "N/m^2")},
             .meaning = "dry friction that changes by slope q + curvature q^2",
             .odds = kRare}) {}

  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    Eigen::MatrixXd parts(q.size(), 2);
    parts.col(0) = -q.cwiseProduct(Direction(at.v()));
    parts.col(1) = parts.col(0).cwiseProduct(q);
    return {LinearRegressor(parts, at.JointEntry(2))};
  }
  // A machine rubs by a few per cent of what its motor does, here or there; by itself the
  // law has to be positive at one end of the stroke at least.
  Sized Draw(const Scales& k, Random& r) const override {
    const double slope = r.Sign() * 0.5 * k.FrictionForce() / k.stroke;
    const double curvature =
        r.Uniform(1.0, 2.0) * k.FrictionForce() / (k.stroke * k.stroke);
    return [=](double s) { return ValuesOf({s * slope, s * curvature}); };
  }
};

}  // namespace

const Effect& PositionDependentFriction() {
  static const PositionDependentFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
