// time_constant df/dt + f = u with u held over a physics step; the mean of f over the
// step drives.

#include <cmath>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class LowPass final : public RememberingEffect<LowPass> {
 public:
  LowPass(const mjModel& model, int actuator, double time_constant)
      : actuator_(actuator) {
    const double ratio = model.opt.timestep / time_constant;
    decay_ = std::exp(-ratio);
    mean_ = -std::expm1(-ratio) / ratio;
  }
  void Drive(const mjModel&, mjData& data) noexcept override {
    mjtNum& command = data.ctrl[actuator_];
    if (!started_) force_ = command;
    started_ = true;
    const double target = command;
    command = target + (force_ - target) * mean_;
    force_ = target + (force_ - target) * decay_;
  }

 private:
  double decay_ = 0.0;
  double mean_ = 0.0;
  double force_ = 0.0;
  bool started_ = false;
  int actuator_;
};

class AmplifierLagEffect final : public Effect {
 public:
  AmplifierLagEffect()
      : Effect({.name = "amplifier_lag",
                .family = Family::kDrive,
                .kind = Kind::kDelay,
                .site = SiteKind::kActuator,
                .variable = LawVariable::kInput,
                .parameters = {Positive("time_constant", Role::kTime, "s")},
                .meaning = "the drive follows its command as a first-order low-pass",
                .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int actuator,
                                         const EffectValues& values) const override {
    return std::make_unique<LowPass>(model, actuator, values[0]);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd u = at.u();
    std::vector<CandidateRegressor> trials;
    for (const double ticks : {0.5, 4.0, 30.0}) {
      trials.push_back({Lagged(u, ticks) - u, at.MotorEntry(),
                        [ticks, tick = at.motion.sample_time](
                            const Amplitudes& a) -> RegressorValues {
                          if (a[0] <= 0.0) return std::nullopt;
                          return ValuesOf({ticks * tick * a[0]});
                        }});
    }
    return trials;
  }
  Sized Draw(const Scales&, Random&) const override { return Proportional(2e-4); }
};

}  // namespace

const Effect& AmplifierLag() {
  static const AmplifierLagEffect effect;
  return effect;
}

}  // namespace mjdiag
