// What happens between a command and the force of a motor.

#include <algorithm>
#include <cmath>
#include <vector>

#include "mjdiag/plugin/effects/effect_factory.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

/// Length of a unit of travel in the actuator's own length.
double GearOf(const mjModel& model, int actuator) {
  return mju_norm(model.actuator_gear + 6 * actuator, 6);
}

/// The motor constant over the travel s of the motor since qpos0:
///   u <- u (1 + slope s + curvature s^2)
class PositionDependentMotorConstant final : public ActiveEffect {
 public:
  PositionDependentMotorConstant(const mjModel& model, const EffectSpec& spec,
                                 int actuator)
      : slope_(spec.Value("slope")),
        curvature_(spec.Value("curvature")),
        gear_(std::max(GearOf(model, actuator), mjMINVAL)),
        actuator_(actuator) {
    const DataPtr data = MakeData(model);
    mj_fwdPosition(&model, data.get());
    rest_ = data->actuator_length[actuator];
  }
  void Drive(const mjModel&, mjData& data) noexcept override {
    const double s = (data.actuator_length[actuator_] - rest_) / gear_;
    data.ctrl[actuator_] *= 1.0 + slope_ * s + curvature_ * s * s;
  }

 private:
  double slope_;
  double curvature_;
  double gear_;
  double rest_ = 0.0;
  int actuator_;
};

/// u(t - delay), averaged over a physics step, so that any delay is exact and not only
/// whole numbers of steps.
class InputDelay final : public ActiveEffect {
 public:
  InputDelay(const mjModel& model, const EffectSpec& spec, int actuator)
      : actuator_(actuator) {
    const double steps = spec.Value("delay") / model.opt.timestep;
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

/// time_constant df/dt + f = u with u held over a physics step; the mean of f over the
/// step drives.
class AmplifierLag final : public ActiveEffect {
 public:
  AmplifierLag(const mjModel& model, const EffectSpec& spec, int actuator)
      : actuator_(actuator) {
    const double ratio = model.opt.timestep / spec.Value("time_constant");
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

}  // namespace

std::unique_ptr<ActiveEffect> MakeDriveEffect(const mjModel& model,
                                              const EffectSpec& spec) {
  const auto id = [&] { return FindElement(model, mjOBJ_ACTUATOR, spec.site); };
  if (spec.effect == "position_dependent_motor_constant") {
    return std::make_unique<PositionDependentMotorConstant>(model, spec, id());
  }
  if (spec.effect == "input_delay") {
    return std::make_unique<InputDelay>(model, spec, id());
  }
  if (spec.effect == "amplifier_lag") {
    return std::make_unique<AmplifierLag>(model, spec, id());
  }
  return nullptr;
}

}  // namespace mjdiag
