// -stiffness (q + loss z), z follows q over `length`: a cable, a hose.
// Passive: it stores stiffness (q^2 + loss z^2) / 2, and takes stiffness loss |v| z^2 /
// length of power beside.

#include "mjdiag/plugin/effects/follower.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class SpringWithMemory final : public RememberingEffect<SpringWithMemory> {
 public:
  SpringWithMemory(const JointOf& joint, const EffectValues& values)
      : stiffness_(values[0]), loss_(values[1]), follower_(values[2]), joint_(joint) {}
  bool FollowsItsJoint() const noexcept override { return true; }
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double z = follower_.Step(data.qvel[joint_.dof], model.opt.timestep);
    const double q = data.qpos[joint_.position] - joint_.rest;
    data.qfrc_applied[joint_.dof] -= stiffness_ * (q + loss_ * z);
  }

 private:
  double stiffness_;
  double loss_;
  Follower follower_;
  JointOf joint_;
};

/// Just after a turn a cable is a few times as stiff as over its whole stroke; what is
/// stiffer is friction that creeps before it slides.
constexpr double kMostLoss = 10.0;

class HystereticStiffnessEffect final : public Effect {
 public:
  HystereticStiffnessEffect()
      : Effect({.name = "hysteretic_stiffness",
                .family = Family::kFriction,
                .kind = Kind::kCompliance,
                .variable = LawVariable::kPosition,
                .parameters = {NotNegative("stiffness", Role::kAmplitude, "N/m"),
                               {.name = "loss",
                                .role = Role::kRatio,
                                .unit = "1",
                                .minimum = 0.0,
                                .maximum = std::numeric_limits<double>::infinity(),
                                .plausible = kMostLoss},
                               Positive("length", Role::kLength, "m")},
                .meaning = "-stiffness (q + loss z), z follows q over that length: a "
                           "cable, a hose",
                .odds = kRare}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<SpringWithMemory>(JointOf(model, joint), values);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    std::vector<CandidateRegressor> trials;
    for (const double length : LogGrid(3e-3 * Range(q), 2.0 * Range(q), 8)) {
      Eigen::MatrixXd parts(q.size(), 2);
      parts << -q, -Follow(q, length);
      trials.push_back(
          {parts, at.JointEntry(2), [length](const Amplitudes& a) -> RegressorValues {
             if (a[0] <= 0.0 || a[1] <= 0.0) return std::nullopt;
             if (a[1] > kMostLoss * a[0]) return std::nullopt;
             return ValuesOf({a[0], a[1] / a[0], length});
           }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    const double loses = self.values[0] * self.values[1];
    if (self.values[1] >= kMostLoss) {
      return PlacedEffect{Lasting(PreslidingHysteresis()), self.site,
                          ValuesOf({loses * self.values[2], loses})};
    }
    return PlacedEffect{Lasting(LinearStiffness()), self.site, self.values.head(1)};
  }
  EffectValues Spread(const Scales&) const override {
    return ValuesOf({kAnySize, kAnySize, kAnySize});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double length = k.stroke * r.Log(0.02, 0.3);
    const double loss = r.Uniform(0.3, 2.0);
    const double stiffness = 0.3 * k.FrictionForce() / k.stroke;
    return [=](double s) { return ValuesOf({s * stiffness, loss, length}); };
  }
};

}  // namespace

const Effect& HystereticStiffness() {
  static const HystereticStiffnessEffect effect;
  return effect;
}

}  // namespace mjdiag
