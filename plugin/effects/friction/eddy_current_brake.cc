// -coefficient v / (1 + (v / velocity)^2): the drag of a conductor in a magnetic field, which
// is viscous while it is slow and falls above the velocity at which it is largest.
// Never against its sign: passive.

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class EddyCurrentBrakeEffect final : public JointForceEffect {
 public:
  EddyCurrentBrakeEffect()
      : JointForceEffect(
            {.name = "eddy_current_brake",
             .family = Family::kFriction,
             .kind = Kind::kViscousFriction,
             .variable = LawVariable::kVelocity,
             .parameters = {NotNegative("coefficient", Role::kAmplitude, "N s/m"),
                            Positive("velocity", Role::kVelocity, "m/s")},
             .meaning = "-coefficient v / (1 + (v / velocity)^2)",
             .odds = kRare}) {}

  double Force(double, double v, double,
               const EffectValues& values) const noexcept override {
    const double ratio = v / values[1];
    return -values[0] * v / (1.0 + ratio * ratio);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::ArrayXd v = at.v();
    const double top = v.abs().maxCoeff();
    std::vector<CandidateRegressor> trials;
    for (const double velocity : LogGrid(0.05 * top, top, 4)) {
      trials.push_back({-v / (1.0 + (v / velocity).square()), at.JointEntry(),
                        [velocity](const Amplitudes& a) -> RegressorValues {
                          if (a[0] <= 0.0) return std::nullopt;
                          return ValuesOf({a[0], velocity});
                        }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(ViscousFriction()), self.site, self.values.head(1)};
  }
  // At its largest it takes half of coefficient velocity.
  Sized Draw(const Scales& k, Random& r) const override {
    const double velocity = k.speed * r.Log(0.1, 0.5);
    return [=, most = 2.0 * k.FrictionForce() / velocity](double s) {
      return ValuesOf({s * most, velocity});
    };
  }
};

}  // namespace

const Effect& EddyCurrentBrake() {
  static const EddyCurrentBrakeEffect effect;
  return effect;
}

}  // namespace mjdiag
