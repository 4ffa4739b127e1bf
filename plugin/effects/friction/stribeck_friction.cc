// Dry friction whose bound falls with speed:
//   F = coulomb + breakaway exp(-(v / velocity)^2)
// as the bound of MuJoCo's own friction constraint, so that it sticks exactly. The
// constant part is in the model; the part that falls with speed is added in every step.

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/trial_signals.h"

namespace mjdiag {
namespace {

class FallingBound final : public VaryingBound {
 public:
  FallingBound(int dof, const EffectValues& values)
      : VaryingBound(dof), breakaway_(values[1]), velocity_(values[2]) {}

 private:
  double Added(const mjModel&, mjData& data) noexcept override {
    const double ratio = data.qvel[dof()] / velocity_;
    return breakaway_ * std::exp(-ratio * ratio);
  }

  double breakaway_;
  double velocity_;
};

class StribeckFrictionEffect final : public Effect {
 public:
  StribeckFrictionEffect()
      : Effect({.name = "stribeck_friction",
                .variable = LawVariable::kVelocity,
                .parameters = {NotNegative("coulomb", Role::kAmplitude, "N"),
                               NotNegative("breakaway", Role::kAmplitude, "N"),
                               Positive("velocity", Role::kVelocity, "m/s")},
                .meaning =
                    "dry friction of coulomb + breakaway exp(-(v / velocity)^2)"}) {}

  void Apply(mjModel& model, int joint, const EffectValues& values) const override {
    AddDryFriction(model, joint, std::max(values[0], kLeastBound));
  }
  void Retract(mjModel& model, int joint, const EffectValues& values) const override {
    TakeDryFriction(model, joint, std::max(values[0], kLeastBound));
  }
  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<FallingBound>(model.jnt_dofadr[joint], values);
  }

  std::vector<Trial> Trials(const SiteMotion& at) const override {
    const Eigen::VectorXd v = at.v();
    const Eigen::VectorXd s = Direction(v);
    const double top = v.cwiseAbs().maxCoeff();
    std::vector<Trial> trials;
    for (const double velocity : LogGrid(0.003 * top, 0.6 * top, 7)) {
      Eigen::MatrixXd parts(v.size(), 2);
      parts.col(0) = -s;
      parts.col(1) = -s.array() * (-(v.array() / velocity).square()).exp();
      trials.push_back(
          {parts, at.JointEntry(2), [velocity](const Amplitudes& a) -> TrialValues {
             if (a[1] <= 0.0 || a[0] < -0.1 * a[1]) return std::nullopt;
             return ValuesOf({std::max(a[0], 0.0), a[1], velocity});
           }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(CoulombFriction()), self.site, self.values.head(1)};
  }
  std::optional<double> Law(double v, const EffectValues& values) const override {
    const double ratio = v / values[2];
    return -Sign(v) * (values[0] + values[1] * std::exp(-ratio * ratio));
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double force = k.SmallForce();
    const double share = r.Uniform(0.2, 1.0);
    const double velocity = k.speed * r.Log(0.01, 0.2);
    return [=](double s) { return ValuesOf({s * share * force, s * force, velocity}); };
  }
};

}  // namespace

const Effect& StribeckFriction() {
  static const StribeckFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
