// amplitude sin(2 pi q / period + phase): cogging.

#include <cmath>
#include <numbers>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/effects/wave.h"

namespace mjdiag {
namespace {

class ForceRippleEffect final : public JointForceEffect {
 public:
  ForceRippleEffect()
      : JointForceEffect(
            {.name = "force_ripple",
             .family = Family::kDrive,
             .kind = Kind::kForceAlongStroke,
             .variable = LawVariable::kPosition,
             .parameters = {Free("amplitude", Role::kAmplitude, "N"),
                            Positive("period", Role::kPeriod, "m"), Phase()},
             .meaning = "amplitude sin(2 pi q / period + phase): cogging",
             .odds = kSome}) {}

  double Force(double q, double, double,
               const EffectValues& values) const noexcept override {
    return values[0] * std::sin(kTurn / values[1] * q + values[2]);
  }
  std::optional<ParameterScan> MakeParameterScan(const SiteMotion& at,
                                                 double) const override {
    constexpr int kFinest = 240;  // more than a motor has poles
    const Eigen::VectorXd q = at.q();
    if (Range(q) == 0.0) return std::nullopt;
    return PeriodScan(at.JointEntry(), q, kFinest, 1);
  }
  EffectValues Spread(const Scales& k) const override {
    return ValuesOf({0.1 * k.force, kAnySize, kAnySize});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double period = k.stroke * r.Log(0.05, 1.0);
    const double phase = r.Uniform(-std::numbers::pi, std::numbers::pi);
    const double amplitude = 0.3 * k.FrictionForce();
    return [=](double s) { return ValuesOf({s * amplitude, period, phase}); };
  }
};

}  // namespace

const Effect& ForceRipple() {
  static const ForceRippleEffect effect;
  return effect;
}

}  // namespace mjdiag
