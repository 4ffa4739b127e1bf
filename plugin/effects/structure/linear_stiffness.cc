// -stiffness q on a joint without a spring, a second spring about the position that
// qpos0 has on one with: that one keeps its preload.

#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

class LinearStiffnessEffect final : public Effect {
 public:
  LinearStiffnessEffect()
      : Effect({.name = "linear_stiffness",
                .family = Family::kStructure,
                .kind = Kind::kCompliance,
                .form = Form::kAttributes,
                .variable = LawVariable::kPosition,
                .parameters = {Free("stiffness", Role::kAmplitude, "N/m")},
                .meaning = "-stiffness q on a joint without a spring, a second spring "
                           "on one with"}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    const int address = model.jnt_qposadr[joint];
    const double added = values[0];
    const double before = model.jnt_stiffness[joint];
    mjtNum& reference = model.qpos_spring[address];
    if (before + added != 0.0) {
      reference =
          (before * reference + added * model.qpos0[address]) / (before + added);
    }
    model.jnt_stiffness[joint] = before + added;
  }
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    return map.Joints(Without(map.driven(), map.Held()));
  }
  double Least(const mjModel& plant, Eigen::Index joint, std::size_t) const override {
    return -plant.jnt_stiffness[plant.dof_jntid[joint]];
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(-at.q(), at.JointEntry())};
  }
  std::optional<double> Law(double q, const EffectValues& values) const override {
    return -values[0] * q;
  }
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(k.FrictionForce() / k.stroke);
  }
};

}  // namespace

const Effect& LinearStiffness() {
  static const LinearStiffnessEffect effect;
  return effect;
}

}  // namespace mjdiag
