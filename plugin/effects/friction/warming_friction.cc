// Dry friction that goes away as grease warms up:
//   F = force exp(-t / time_constant)
// beside the friction that is left then, as the bound of MuJoCo's own friction constraint;
// t since the start of the run.

#include <cmath>

#include "mjdiag/plugin/effects/friction/dry_friction.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class BoundByTime final : public VaryingBound {
 public:
  BoundByTime(const JointOf& joint, const EffectValues& values)
      : VaryingBound(joint.dof), force_(values[0]), rate_(1.0 / values[1]) {}

 private:
  double Added(const mjModel&, mjData& data) noexcept override {
    return force_ * std::exp(-data.time * rate_);
  }

  double force_;
  double rate_;
};

class WarmingFrictionEffect final : public VaryingFrictionEffect<BoundByTime> {
 public:
  WarmingFrictionEffect()
      : VaryingFrictionEffect(
            {.name = "warming_friction",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .variable = LawVariable::kTime,
             .parameters = {NotNegative("force", Role::kAmplitude, "N"),
                            Positive("time_constant", Role::kDuration, "s")},
             .meaning = "dry friction that goes away: force exp(-t / time_constant)",
             .odds = kRare}) {}

  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd s = Direction(at.v());
    const double last = at.motion.time.maxCoeff();
    std::vector<CandidateRegressor> trials;
    for (const double constant : LogGrid(0.05 * last, 2.0 * last, 4)) {
      trials.push_back({-s.array() * (-at.motion.time.array() / constant).exp(),
                        at.JointEntry(),
                        [constant](const Amplitudes& a) -> RegressorValues {
                          if (a[0] <= 0.0) return std::nullopt;
                          return ValuesOf({a[0], constant});
                        }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(CoulombFriction()), self.site, self.values.head(1)};
  }
  // Within the run, or nobody could see it.
  Sized Draw(const Scales& k, Random& r) const override {
    const double constant = k.duration * r.Log(0.1, 0.5);
    return [=, force = k.FrictionForce()](double s) {
      return ValuesOf({s * force, constant});
    };
  }
};

}  // namespace

const Effect& WarmingFriction() {
  static const WarmingFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
