// The joint's spring does not act within gap / 2 of its rest: gives back what MuJoCo's
// spring takes there. A force of the position alone, which stores: with the spring the
// energy of a strain beyond the gap.

#include <algorithm>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/effects/structure/joint_spring.h"

namespace mjdiag {
namespace {

class Play final : public ActiveEffect {
 public:
  Play(const mjModel& model, int joint, double gap)
      : half_gap_(0.5 * gap),
        stiffness_(model.jnt_stiffness[joint]),
        joint_(model, joint),
        rest_(model.qpos_spring[joint_.position]) {}
  bool FollowsItsJoint() const noexcept override { return true; }
  void Push(const mjModel&, mjData& data) noexcept override {
    const double strain = data.qpos[joint_.position] - rest_;
    data.qfrc_applied[joint_.dof] +=
        stiffness_ * std::clamp(strain, -half_gap_, half_gap_);
  }

 private:
  double half_gap_;
  double stiffness_;
  JointOf joint_;
  double rest_;
};

class BacklashEffect final : public Effect {
 public:
  BacklashEffect()
      : Effect({.name = "backlash",
                .family = Family::kStructure,
                .kind = Kind::kPlay,
                .site = SiteKind::kHeldJoint,
                .variable = LawVariable::kPosition,
                .parameters = {NotNegative("gap", Role::kGap, "m")},
                .meaning = "play of that full width in what holds the joint",
                .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<Play>(model, joint, values[0]);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const auto [stiffness, strain] = JointSpring(at);
    const double most = strain.cwiseAbs().maxCoeff();
    std::vector<CandidateRegressor> trials;
    // The force within a gap is proportional to it as long as it is small.
    for (const double half : LogGrid(0.01 * most, most, 8)) {
      trials.push_back({stiffness * strain.cwiseMax(-half).cwiseMin(half),
                        at.JointEntry(),
                        [half](const Amplitudes& a) -> RegressorValues {
                          if (a[0] <= 0.0) return std::nullopt;
                          return ValuesOf({2.0 * half * std::min(a[0], 3.0)});
                        }});
    }
    return trials;
  }
  Sized Draw(const Scales& k, Random&) const override { return Proportional(k.strain); }
};

}  // namespace

const Effect& Backlash() {
  static const BacklashEffect effect;
  return effect;
}

}  // namespace mjdiag
