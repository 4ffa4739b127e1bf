// Dry friction that grows with what a drive transmits, and more so where it is slow:
//   F = (coefficient + breakaway exp(-(v / velocity)^2)) |motor - rest|
// with motor and rest as load_friction has them (drive_load.h), as the bound of MuJoCo's
// own friction constraint. [Duclusaud 2024]

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/trial_signals.h"

namespace mjdiag {
namespace {

class FallingLoadBound final : public VaryingBound {
 public:
  FallingLoadBound(int dof, const EffectValues& values)
      : VaryingBound(dof),
        coefficient_(values[0]),
        breakaway_(values[1]),
        velocity_(values[2]) {}

 private:
  double Added(const mjModel& model, mjData& data) noexcept override {
    const DriveLoad load = DriveLoadOf(model, data, dof());
    const double ratio = data.qvel[dof()] / velocity_;
    return (coefficient_ + breakaway_ * std::exp(-ratio * ratio)) *
           std::abs(load.motor - load.rest);
  }

  double coefficient_;
  double breakaway_;
  double velocity_;
};

class StribeckLoadFrictionEffect final : public Effect {
 public:
  StribeckLoadFrictionEffect()
      : Effect({.name = "stribeck_load_friction",
                .variable = LawVariable::kVelocity,
                .parameters = {NotNegative("coefficient", Role::kAmplitude, "1"),
                               NotNegative("breakaway", Role::kAmplitude, "1"),
                               Positive("velocity", Role::kVelocity, "m/s")},
                .meaning = "dry friction of (coefficient + breakaway exp(-(v / "
                           "velocity)^2)) |what the drive transmits|"}) {}

  void Apply(mjModel& model, int joint, const EffectValues&) const override {
    AddDryFriction(model, joint, kLeastBound);
  }
  void Retract(mjModel& model, int joint, const EffectValues&) const override {
    TakeDryFriction(model, joint, kLeastBound);
  }
  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<FallingLoadBound>(model.jnt_dofadr[joint], values);
  }

  std::vector<Trial> Trials(const SiteMotion& at) const override {
    const ObservedLoad load(at);
    const Eigen::VectorXd v = at.v();
    const Eigen::VectorXd slide =
        -(load.motor - load.rest).cwiseAbs().cwiseProduct(Direction(v));
    const double top = v.cwiseAbs().maxCoeff();
    std::vector<Trial> trials;
    for (const double velocity : LogGrid(0.003 * top, 0.6 * top, 7)) {
      Eigen::MatrixXd parts(v.size(), 2);
      parts.col(0) = slide;
      parts.col(1) = slide.array() * (-(v.array() / velocity).square()).exp();
      trials.push_back(
          {parts, at.JointEntry(2), [velocity](const Amplitudes& a) -> TrialValues {
             if (a[1] <= 0.0 || a[0] < -0.1 * a[1]) return std::nullopt;
             return ValuesOf({std::max(a[0], 0.0), a[1], velocity});
           }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(LoadFriction()), self.site, self.values.head(1)};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double share = r.Uniform(0.2, 1.0);
    const double velocity = k.speed * r.Log(0.01, 0.2);
    return [=](double s) { return ValuesOf({0.2 * s * share, 0.2 * s, velocity}); };
  }
};

}  // namespace

const Effect& StribeckLoadFriction() {
  static const StribeckLoadFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
