// The zero of a hinge's encoder is off: where the hinge reads q it is at q - offset. Gravity
// and springs act at the true angle. In the model the body's reference, and with it that of
// the spring, moves to the reading offset. The same as a machine that is tilted about the
// axis of its only hinge.

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Force of gravity and of the spring on a hinge, over its angle, the others where they
/// are, without what touches it.
class StaticForce {
 public:
  explicit StaticForce(const mjModel& plant) : plant_(plant), data_(MakeData(plant)) {}
  /// @param position  of all joints, from qpos0
  double At(const VectorXd& position, Index joint, double change) {
    VectorXd::Map(data_->qpos, plant_.nq) =
        VectorXd::Map(plant_.qpos0, plant_.nq) + position;
    data_->qpos[joint] += change;
    // Of mj_fwdPosition what these forces need: a screening asks at every sample.
    mj_kinematics(&plant_, data_.get());
    mj_comPos(&plant_, data_.get());
    mj_tendon(&plant_, data_.get());
    mj_transmission(&plant_, data_.get());
    mj_fwdVelocity(&plant_, data_.get());
    return data_->qfrc_passive[joint] - data_->qfrc_bias[joint];
  }
  double Slope(const VectorXd& position, Index joint) {
    constexpr double kStep = 1e-4;  // rad
    return (At(position, joint, kStep) - At(position, joint, -kStep)) / (2.0 * kStep);
  }

 private:
  const mjModel& plant_;
  DataPtr data_;
};

class ZeroOffsetEffect final : public Effect {
 public:
  ZeroOffsetEffect()
      : Effect({.name = "zero_offset",
                .family = Family::kEncoder,
                .kind = Kind::kEncoder,
                .site = SiteKind::kHinge,
                .variable = LawVariable::kPosition,
                .parameters = {Free("offset", Role::kAmplitude, "rad")},
                .meaning =
                    "the zero of the hinge's encoder is off: it reads its angle + "
                    "offset"}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    Move(model, joint, values[0]);
  }
  void Retract(mjModel& model, int joint, const EffectValues& values) const override {
    Move(model, joint, -values[0]);
  }
  /// Hinges that a sensor sees and on which the static force changes with the angle.
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    StaticForce force(map.plant());
    std::vector<Index> joints = ToldJoints(map.model());
    std::ranges::sort(joints);
    joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
    std::erase_if(joints, [&](Index joint) {
      const int id = map.plant().dof_jntid[joint];
      if (map.plant().jnt_type[id] != mjJNT_HINGE) return true;
      const VectorXd rest = VectorXd::Zero(map.plant().nq);
      const double scale = map.model().M(joint, joint);  // against 1 rad/s^2 per rad
      return std::abs(force.Slope(rest, joint)) < 1e-6 * scale;
    });
    return map.Joints(joints);
  }
  // F(q - offset) = F(q) - offset dF/dq
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    StaticForce force(at.plant);
    VectorXd slope(at.motion.samples());
    for (Index k = 0; k < slope.size(); ++k) {
      slope[k] = force.Slope(at.motion.position.col(k), at.site.joint);
    }
    return {LinearRegressor(-slope, at.JointEntry())};
  }
  EffectValues Spread(const Scales&) const override { return ValuesOf({0.1}); }
  // Teeth of a horn or a coupling are some degrees apart; what is left is a part of that.
  Sized Draw(const Scales&, Random& r) const override {
    return Proportional(r.Sign() * 0.05);
  }

 private:
  static void Move(mjModel& model, int joint, double offset) {
    const int address = model.jnt_qposadr[joint];
    model.qpos0[address] += offset;
    model.qpos_spring[address] += offset;
  }
};

}  // namespace

const Effect& ZeroOffset() {
  static const ZeroOffsetEffect effect;
  return effect;
}

}  // namespace mjdiag
