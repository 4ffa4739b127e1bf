// -force tanh(v / velocity): dry friction that creeps, as lubricated joints do and as it is
// mostly written for identification.

#include <cmath>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class SmoothCoulombFrictionEffect final : public JointForceEffect {
 public:
  SmoothCoulombFrictionEffect()
      : JointForceEffect(
            {.name = "smooth_coulomb_friction",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("force", Role::kAmplitude, "N"),
                            Positive("velocity", Role::kVelocity, "m/s")},
             .meaning = "-force tanh(v / velocity): dry friction that creeps",
             .odds = kSome}) {}

  double Force(double, double v, double,
               const EffectValues& values) const noexcept override {
    return -values[0] * std::tanh(v / values[1]);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::ArrayXd v = at.v();
    const double top = v.abs().maxCoeff();
    std::vector<CandidateRegressor> trials;
    // Above half of the largest speed it is viscous.
    for (const double velocity : LogGrid(0.01 * top, 0.5 * top, 6)) {
      trials.push_back({-(v / velocity).tanh(), at.JointEntry(),
                        [velocity](const Amplitudes& a) -> RegressorValues {
                          if (a[0] <= 0.0) return std::nullopt;
                          return ValuesOf({a[0], velocity});
                        }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(CoulombFriction()), self.site, self.values.head(1)};
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double velocity = k.speed * r.Log(0.03, 0.3);
    return [=, most = k.FrictionForce()](double s) {
      return ValuesOf({s * most, velocity});
    };
  }
};

}  // namespace

const Effect& SmoothCoulombFriction() {
  static const SmoothCoulombFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
