// Dry friction of a drive that grows with what it transmits, a harmonic drive's main
// friction:
//   F = coefficient |motor - rest|
// with the force of the motors on the joint and the rest of the force on it (gravity,
// springs, dampers, velocity products, other effects), as the bound of MuJoCo's own
// friction constraint, so that it sticks exactly. [Duclusaud 2024]

#include <cmath>

#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class BoundByLoad final : public VaryingBound {
 public:
  BoundByLoad(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof), coefficient_(values[0]) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    const DriveLoad load = DriveLoadOf(model, data, dof());
    return coefficient_ * std::abs(load.motor - load.rest);
  }

  double coefficient_;
};

class LoadFrictionEffect final : public VaryingFrictionEffect<BoundByLoad> {
 public:
  LoadFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "load_friction",
             .family = Family::kFriction,
             .kind = Kind::kLoadFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("coefficient", Role::kAmplitude, "1")},
             .meaning = "dry friction of coefficient |what the drive transmits|: "
                        "motor less the rest of the force on the joint"}) {}

  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const ObservedLoad load(at);
    const Eigen::VectorXd bound = (load.motor - load.rest).cwiseAbs();
    return {LinearRegressor(-bound.cwiseProduct(Direction(at.v())), at.JointEntry(),
                            0.0, true)};
  }
  Sized Draw(const Scales&, Random&) const override { return Proportional(0.2); }
};

}  // namespace

const Effect& LoadFriction() {
  static const LoadFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
