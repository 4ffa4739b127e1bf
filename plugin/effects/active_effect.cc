#include "mjdiag/plugin/effects/active_effect.h"

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/plant/motor_force.h"

namespace mjdiag {

ActiveEffects::ActiveEffects(const Channels& channels, const mjModel& model,
                             const std::vector<PlacedEffect>& effects) {
  for (const PlacedEffect& placed : effects) {
    const int element = CheckEffect(model, placed);
    auto active = placed.effect->Activate(model, channels, element, placed.values);
    if (!active) continue;
    effects_.push_back(std::move(active));
    if (placed.effect->element() == mjOBJ_JOINT) {
      dofs_.push_back(model.jnt_dofadr[element]);
    }
  }
}

void ActiveEffects::Distort(std::span<double> readings, double time) noexcept {
  for (const auto& effect : effects_) effect->Distort(readings, time);
}

void ActiveEffects::Act(const mjModel& model, mjData& data,
                        std::span<const int> off) noexcept {
  Release(data);
  for (const auto& effect : effects_) effect->Drive(model, data);
  for (const int motor : off) data.ctrl[motor] = OpenCircuitCommand(model, data, motor);
  for (const auto& effect : effects_) effect->Push(model, data);
  for (const auto& effect : effects_) effect->Bind(model, data);
}

void ActiveEffects::Release(mjData& data) noexcept {
  for (const int dof : dofs_) data.qfrc_applied[dof] = 0.0;
}

Channels WithNoiseOf(Channels channels, const std::vector<PlacedEffect>& effects) {
  for (const PlacedEffect& placed : effects) {
    for (SensorSetup& sensor : channels.sensors) {
      if (sensor.element != placed.site) continue;
      sensor.noise_sd = placed.effect->NoiseSd(sensor.noise_sd, placed.values);
    }
  }
  return channels;
}

}  // namespace mjdiag
