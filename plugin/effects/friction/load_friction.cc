// Dry friction of a drive that grows with what it transmits, a harmonic drive's main
// friction:
//   F = coefficient |motor - rest|
// with the force of the motors on the joint and the rest of the force on it (gravity,
// springs, dampers, velocity products, other effects), as the bound of MuJoCo's own
// friction constraint, so that it sticks exactly. [Duclusaud 2024]

#include <cmath>

#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/trial_signals.h"
#include "mjdiag/plugin/plant/motor_force.h"

namespace mjdiag {
namespace {

class BoundByLoad final : public VaryingBound {
 public:
  BoundByLoad(int dof, double coefficient)
      : VaryingBound(dof), coefficient_(coefficient) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    double load =
        data.qfrc_bias[dof()] - data.qfrc_passive[dof()] - data.qfrc_applied[dof()];
    for (int motor = 0; motor < model.nu; ++motor) {
      const double arm = data.actuator_moment[motor * model.nv + dof()];
      if (arm != 0.0) load += arm * MotorForce(model, data, motor);
    }
    return coefficient_ * std::abs(load);
  }

  double coefficient_;
};

class LoadFrictionEffect final : public Effect {
 public:
  LoadFrictionEffect()
      : Effect({.name = "load_friction",
                .variable = LawVariable::kVelocity,
                .parameters = {NotNegative("coefficient", Role::kAmplitude, "1")},
                .meaning = "dry friction of coefficient |what the drive transmits|: "
                           "motor less the rest of the force on the joint"}) {}

  void Apply(mjModel& model, int joint, const EffectValues&) const override {
    AddDryFriction(model, joint, kLeastBound);
  }
  void Retract(mjModel& model, int joint, const EffectValues&) const override {
    TakeDryFriction(model, joint, kLeastBound);
  }
  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<BoundByLoad>(model.jnt_dofadr[joint], values[0]);
  }

  // Along a motion the rest is what accelerates the joint beside its motors, to first
  // order without this friction: M a - motor, so that the load is 2 motor - M a.
  std::vector<Trial> Trials(const SiteMotion& at) const override {
    const Eigen::VectorXd motor =
        at.motion.inputs.transpose() * at.model.Gamma.row(at.site.joint).transpose();
    const Eigen::VectorXd inertial =
        at.motion.acceleration.transpose() * at.model.M.row(at.site.joint).transpose();
    const Eigen::VectorXd load = (2.0 * motor - inertial).cwiseAbs();
    return {
        LinearTrial(-load.cwiseProduct(Direction(at.v())), at.JointEntry(), 0.0, true)};
  }
  Sized Draw(const Scales&, Random&) const override { return Proportional(0.2); }
};

}  // namespace

const Effect& LoadFriction() {
  static const LoadFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
