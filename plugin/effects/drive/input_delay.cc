// u(t - delay), averaged over a physics step, so that any delay is exact and not only
// whole numbers of steps.

#include <algorithm>
#include <cmath>
#include <vector>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

constexpr double kLongest = 0.1;  // [s]

class DelayLine final : public RememberingEffect<DelayLine> {
 public:
  DelayLine(const mjModel& model, int actuator, double delay) : actuator_(actuator) {
    const double steps = delay / model.opt.timestep;
    const double whole = std::floor(steps);
    fraction_ = steps - whole;
    whole_ = static_cast<std::size_t>(whole);
    past_.resize(whole_ + 2);
  }
  void Drive(const mjModel&, mjData& data) noexcept override {
    mjtNum& command = data.ctrl[actuator_];
    if (!started_) std::fill(past_.begin(), past_.end(), command);
    started_ = true;
    now_ = (now_ + 1) % past_.size();
    past_[now_] = command;
    command = (1.0 - fraction_) * Past(whole_) + fraction_ * Past(whole_ + 1);
  }

 private:
  double Past(std::size_t steps) const noexcept {
    return past_[(now_ + past_.size() - steps) % past_.size()];
  }

  std::vector<double> past_;
  std::size_t whole_ = 0;
  std::size_t now_ = 0;
  double fraction_ = 0.0;
  bool started_ = false;
  int actuator_;
};

class InputDelayEffect final : public Effect {
 public:
  InputDelayEffect()
      : Effect({.name = "input_delay",
                .family = Family::kDrive,
                .kind = Kind::kDelay,
                .site = SiteKind::kActuator,
                .variable = LawVariable::kInput,
                .parameters = {{"delay", Role::kTime, "s", 0.0, kLongest}},
                .meaning = "the drive follows its command that much later"}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int actuator,
                                         const EffectValues& values) const override {
    return std::make_unique<DelayLine>(model, actuator, values[0]);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {{Delayed(at.u()) - at.u(), at.MotorEntry(),
             [tick = at.motion.sample_time](const Amplitudes& a) -> RegressorValues {
               if (a[0] <= 0.0) return std::nullopt;
               return ValuesOf({std::min(a[0] * tick, kLongest)});
             }}};
  }
  Sized Draw(const Scales&, Random&) const override { return Proportional(2e-4); }
};

}  // namespace

const Effect& InputDelay() {
  static const InputDelayEffect effect;
  return effect;
}

}  // namespace mjdiag
