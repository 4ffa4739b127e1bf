// coefficient times the force of the motors that do not drive the joint: leakage of a
// magnet circuit, a belt that pulls a neighbour along, a reaction force that a guide takes.

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

/// Behind its gear [N, N m].
double ForceBehindGear(const mjModel& model, const mjData& data, int motor) {
  return GearOf(model, motor) * MotorForce(model, data, motor);
}

class CoupledForce final : public ActiveEffect {
 public:
  CoupledForce(int dof, double coefficient) : coefficient_(coefficient), dof_(dof) {}
  void Push(const mjModel& model, mjData& data) noexcept override {
    double sum = 0.0;
    for (int motor = 0; motor < model.nu; ++motor) {
      if (data.actuator_moment[motor * model.nv + dof_] != 0.0) continue;
      sum += ForceBehindGear(model, data, motor);
    }
    data.qfrc_applied[dof_] += coefficient_ * sum;
  }

 private:
  double coefficient_;
  int dof_;
};

/// Whether the motor of a channel leaves the joint alone.
bool IsOther(const MechanicalModel& model, Eigen::Index joint, Eigen::Index channel) {
  return model.Gamma(joint, channel) == 0.0;
}

class ForceCouplingEffect final : public Effect {
 public:
  ForceCouplingEffect()
      : Effect({.name = "force_coupling",
                .family = Family::kDrive,
                .kind = Kind::kCoupling,
                .variable = LawVariable::kInput,
                .parameters = {Free("coefficient", Role::kAmplitude, "1")},
                .meaning = "coefficient times the force of the motors of other joints",
                .odds = kRare}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<CoupledForce>(model.jnt_dofadr[joint], values[0]);
  }
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    std::vector<Eigen::Index> joints = map.driven();
    std::erase_if(joints, [&](Eigen::Index joint) {
      return (map.model().Gamma.row(joint).array() != 0.0).all();
    });
    return map.Joints(joints);
  }
  // Gamma has a motor's force on the joints that it drives, one of which has all of it.
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(at.motion.samples());
    for (Eigen::Index u = 0; u < at.model.Gamma.cols(); ++u) {
      if (!IsOther(at.model, at.site.joint, u)) continue;
      const double force = at.model.Gamma.col(u).cwiseAbs().maxCoeff();
      sum += force * at.motion.inputs.row(u).transpose();
    }
    return {LinearRegressor(sum, at.JointEntry())};
  }
  EffectValues Spread(const Scales&) const override { return ValuesOf({0.3}); }
  Sized Draw(const Scales&, Random& r) const override {
    return Proportional(r.Sign() * 0.05);
  }
};

}  // namespace

const Effect& ForceCoupling() {
  static const ForceCouplingEffect effect;
  return effect;
}

}  // namespace mjdiag
