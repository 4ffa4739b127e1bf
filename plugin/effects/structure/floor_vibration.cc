// amplitude sin(2 pi frequency t + phase): what the floor passes on.

#include <cmath>
#include <numbers>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/wave.h"

namespace mjdiag {
namespace {

class FloorVibrationEffect final : public JointForceEffect {
 public:
  FloorVibrationEffect()
      : JointForceEffect(
            {.name = "floor_vibration",
             .family = Family::kStructure,
             .kind = Kind::kVibration,
             .variable = LawVariable::kTime,
             .parameters = {Free("amplitude", Role::kAmplitude, "N"),
                            Positive("frequency", Role::kFrequency, "Hz"), Phase()},
             .meaning = "amplitude sin(2 pi frequency t + phase): what the floor "
                        "passes on",
             .odds = kRare}) {}

  double Force(double, double, double time,
               const EffectValues& values) const noexcept override {
    return values[0] * std::sin(kTurn * values[1] * time + values[2]);
  }
  /// Joints that stand on the floor; those that no motor holds, if there are any.
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    const std::vector<Eigen::Index> ground = map.Ground();
    const std::vector<Eigen::Index> passive = Without(ground, map.driven());
    return map.Joints(passive.empty() ? ground : passive);
  }
  std::optional<ParameterScan> MakeParameterScan(const SiteMotion& at,
                                                 double duration) const override {
    return FrequencyScan(at.JointEntry(), at.motion, duration);
  }
  // A tenth of gravity shakes everything.
  EffectValues Spread(const Scales& k) const override {
    return ValuesOf({k.mass, kAnySize, kAnySize});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    constexpr double kShaking = 2.0;  // [m/s^2], a fifth of gravity
    const double frequency = r.Log(8.0, 200.0);
    const double phase = r.Uniform(-std::numbers::pi, std::numbers::pi);
    return [=, mass = k.mass](double s) {
      return ValuesOf({s * kShaking * mass, frequency, phase});
    };
  }
};

}  // namespace

const Effect& FloorVibration() {
  static const FloorVibrationEffect effect;
  return effect;
}

}  // namespace mjdiag
