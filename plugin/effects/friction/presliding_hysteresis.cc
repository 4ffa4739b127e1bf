// P. R. Dahl, "A solid friction model", 1968: -stiffness z, z follows q over the length
// force / stiffness. Passive: it takes stiffness |v| z^2 / length of power more than
// it stores, which is stiffness z^2 / 2.

#include "mjdiag/plugin/effects/follower.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class Presliding final : public RememberingEffect<Presliding> {
 public:
  Presliding(int dof, const EffectValues& values)
      : stiffness_(values[1]),
        follower_(values[0] / stiffness_),
        active_(values[0] > 0.0),
        dof_(dof) {}
  bool FollowsItsJoint() const noexcept override { return true; }
  void Push(const mjModel& model, mjData& data) noexcept override {
    if (!active_) return;
    data.qfrc_applied[dof_] -=
        stiffness_ * follower_.Step(data.qvel[dof_], model.opt.timestep);
  }

 private:
  double stiffness_;
  Follower follower_;
  bool active_;
  int dof_;
};

class PreslidingHysteresisEffect final : public Effect {
 public:
  PreslidingHysteresisEffect()
      : Effect(
            {.name = "presliding_hysteresis",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .variable = LawVariable::kPosition,
             .parameters = {NotNegative("force", Role::kAmplitude, "N"),
                            Positive("stiffness", Role::kSteepness, "N/m")},
             .meaning = "Dahl friction: springs with that stiffness before it slides",
             .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<Presliding>(model.jnt_dofadr[joint], values);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    std::vector<CandidateRegressor> trials;
    // Encoders tell a millionth of their stroke.
    for (const double length : LogGrid(1e-6 * Range(q), 0.5 * Range(q), 12)) {
      trials.push_back({-Follow(q, length) / length, at.JointEntry(),
                        [length](const Amplitudes& a) -> RegressorValues {
                          if (a[0] <= 0.0) return std::nullopt;
                          return ValuesOf({a[0], a[0] / length});
                        }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(CoulombFriction()), self.site, self.values.head(1)};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double force = k.FrictionForce();
    const double length = k.stroke * r.Log(1e-3, 0.1);
    return [=](double s) { return ValuesOf({s * force, s * force / length}); };
  }
};

}  // namespace

const Effect& PreslidingHysteresis() {
  static const PreslidingHysteresisEffect effect;
  return effect;
}

}  // namespace mjdiag
