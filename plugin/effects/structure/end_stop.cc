// A spring beyond position, on the side of its sign. It stores, and takes nothing.

#include <cmath>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class EndStopEffect final : public JointForceEffect {
 public:
  EndStopEffect()
      : JointForceEffect(
            {.name = "end_stop",
             .family = Family::kStructure,
             .kind = Kind::kEndStop,
             .variable = LawVariable::kPosition,
             .parameters = {Free("position", Role::kPosition, "m"),
                            NotNegative("stiffness", Role::kAmplitude, "N/m")},
             .meaning = "a spring beyond position, on the side of its sign",
             .odds = kSome}) {}

  double Force(double q, double, double,
               const EffectValues& values) const noexcept override {
    const double position = values[0];
    const double beyond = q - position;
    const bool touches = position >= 0.0 ? beyond > 0.0 : beyond < 0.0;
    return touches ? -values[1] * beyond : 0.0;
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    std::vector<CandidateRegressor> trials;
    for (const double share : {0.3, 0.6, 0.8, 0.9, 0.95, 0.99}) {
      for (const double side : {q.maxCoeff(), q.minCoeff()}) {
        const double position = share * side;
        if (std::abs(position) < 0.05 * Range(q)) continue;
        Eigen::VectorXd beyond = q.array() - position;
        if (position > 0.0) {
          beyond = beyond.cwiseMax(0.0).eval();
        } else {
          beyond = beyond.cwiseMin(0.0).eval();
        }
        trials.push_back({-beyond, at.JointEntry(),
                          [position](const Amplitudes& a) -> RegressorValues {
                            if (a[0] <= 0.0) return std::nullopt;
                            return ValuesOf({position, a[0]});
                          }});
      }
    }
    return trials;
  }
  EffectValues Spread(const Scales&) const override {
    return ValuesOf({kAnySize, kAnySize});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double position = r.Uniform(0.5, 0.95) * k.stroke;
    return [=, force = k.FrictionForce(), stroke = k.stroke](double s) {
      return ValuesOf({position, s * force / (0.1 * stroke)});
    };
  }
};

}  // namespace

const Effect& EndStop() {
  static const EndStopEffect effect;
  return effect;
}

}  // namespace mjdiag
