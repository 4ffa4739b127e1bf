// Dry friction of a drive that grows with the square of what it transmits, as its teeth
// press harder and on more of their faces:
//   F = coefficient (motor - rest)^2
// with motor and rest as load_friction has them (drive_load.h), as the bound of MuJoCo's
// own friction constraint. Beside load_friction it is the second term of a series.

#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class BoundByLoadSquared final : public VaryingBound {
 public:
  BoundByLoadSquared(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof), coefficient_(values[0]) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    const DriveLoad load = DriveLoadOf(model, data, dof());
    const double transmitted = load.motor - load.rest;
    return coefficient_ * transmitted * transmitted;
  }

  double coefficient_;
};

class QuadraticLoadFrictionEffect final
    : public VaryingFrictionEffect<BoundByLoadSquared> {
 public:
  QuadraticLoadFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "quadratic_load_friction",
             .family = Family::kFriction,
             .kind = Kind::kLoadFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("coefficient", Role::kAmplitude, "1/N")},
             .meaning = "dry friction of coefficient (what the drive transmits)^2",
             .odds = kSome}) {}

  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const ObservedLoad load(at);
    const Eigen::VectorXd bound = (load.motor - load.rest).cwiseAbs2();
    return {LinearRegressor(-bound.cwiseProduct(Direction(at.v())), at.JointEntry(),
                            0.0, true)};
  }
  // A fifth of the motor's force where that is largest, as load_friction; a drive that
  // carries a load transmits twice the motor's.
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(0.1 / k.force);
  }
};

}  // namespace

const Effect& QuadraticLoadFriction() {
  static const QuadraticLoadFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
