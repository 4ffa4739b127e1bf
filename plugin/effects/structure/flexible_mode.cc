// A mass m on the joint by a spring and a damper, x its position:
//   m x'' = -f,  f = m (omega^2 (x - q) + 2 zeta omega (x' - v)),  f on the joint
// integrated as MuJoCo's Euler does (velocity first). Passive: a mass, a spring and a damper
// of no negative size.

#include <cmath>
#include <string>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/effects/wave.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

class Appendage final : public RememberingEffect<Appendage> {
 public:
  Appendage(const JointOf& joint, const EffectValues& values)
      : mass_(values[0]), joint_(joint) {
    const double omega = kTurn * values[1];
    stiffness_ = omega * omega;
    damping_ = 2.0 * values[2] * omega;
  }
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double q = data.qpos[joint_.position];
    const double v = data.qvel[joint_.dof];
    if (!body_.has_begun) body_ = {q, v, true};
    const double pull =
        stiffness_ * (body_.position - q) + damping_ * (body_.velocity - v);
    data.qfrc_applied[joint_.dof] += mass_ * pull;
    body_.velocity -= model.opt.timestep * pull;
    body_.position += model.opt.timestep * body_.velocity;
  }
  CarriedBody* Body() noexcept override { return &body_; }

 private:
  double mass_;
  double stiffness_ = 0.0;
  double damping_ = 0.0;
  CarriedBody body_;
  JointOf joint_;
};

class FlexibleModeEffect final : public Effect {
 public:
  FlexibleModeEffect()
      : Effect(
            {.name = "flexible_mode",
             .family = Family::kStructure,
             .kind = Kind::kCompliance,
             .variable = LawVariable::kAcceleration,
             .parameters = {NotNegative("mass", Role::kAmplitude, "kg"),
                            Positive("frequency", Role::kFrequency, "Hz"),
                            // Joints of machines damp by some per cent, rubber by 20.
                            {.name = "damping_ratio",
                             .role = Role::kRatio,
                             .unit = "1",
                             .minimum = 0.0,
                             .maximum = 1.0,
                             .plausible = 0.3}},
             .meaning = "a mass on a spring and a damper on the joint",
             .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    // Where v+ = (1 - 2 ratio w h) v - w^2 h x, x+ = x + h v+ grow, it would drive.
    const double ratio = values[2];
    const double most =
        2.0 * (std::sqrt(ratio * ratio + 1.0) - ratio) / (kTurn * model.opt.timestep);
    if (values[1] >= most) {
      throw InputError(Where(*this, ElementName(model, mjOBJ_JOINT, joint)),
                       "frequency = " + std::to_string(values[1]),
                       "below " + std::to_string(most) +
                           " Hz, which a step of the physics resolves");
    }
    return std::make_unique<Appendage>(JointOf(model, joint), values);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const double tick = at.motion.sample_time;
    const double highest = 0.2 / tick;
    std::vector<CandidateRegressor> trials;
    for (const double frequency : LogGrid(2e-3 * highest, highest, 40)) {
      for (const double ratio : {0.01, 0.05, 0.2}) {
        trials.push_back({AppendagePull(at.q(), frequency, ratio, tick),
                          at.JointEntry(),
                          [frequency, ratio](const Amplitudes& a) -> RegressorValues {
                            if (a[0] <= 0.0) return std::nullopt;
                            return ValuesOf({a[0], frequency, ratio});
                          }});
      }
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(AddedMass()), self.site, self.values.head(1)};
  }
  EffectValues Spread(const Scales& k) const override {
    return ValuesOf({0.5 * k.mass, kAnySize, kAnySize});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double frequency = r.Log(40.0, 400.0);
    const double ratio = r.Uniform(0.01, 0.1);
    return [=, mass = k.mass](double s) {
      return ValuesOf({s * 0.3 * mass, frequency, ratio});
    };
  }
};

}  // namespace

const Effect& FlexibleMode() {
  static const FlexibleModeEffect effect;
  return effect;
}

}  // namespace mjdiag
