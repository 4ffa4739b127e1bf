#include "mjdiag/plugin/effects/active_effect.h"

#include <cmath>

#include "mjdiag/plugin/effects/effect_factory.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

std::unique_ptr<ActiveEffect> Make(const Channels& channels, const mjModel& model,
                                   const EffectSpec& spec) {
  if (auto effect = MakeFrictionEffect(model, spec)) return effect;
  if (auto effect = MakeDriveEffect(model, spec)) return effect;
  if (auto effect = MakeStructureEffect(model, spec)) return effect;
  return MakeEncoderEffect(channels, spec);
}

}  // namespace

JointOf FindJoint(const mjModel& model, const EffectSpec& spec) {
  const int joint = FindElement(model, mjOBJ_JOINT, spec.site);
  const int position = model.jnt_qposadr[joint];
  return {model.jnt_dofadr[joint], position, model.qpos0[position]};
}

ActiveEffects::ActiveEffects(const Channels& channels, const mjModel& model,
                             const std::vector<EffectSpec>& effects) {
  for (const EffectSpec& spec : effects) {
    CheckEffect(model, spec);
    auto effect = Make(channels, model, spec);
    if (!effect) continue;
    effects_.push_back(std::move(effect));
    if (FindEffect(spec.effect).element() == mjOBJ_JOINT) {
      dofs_.push_back(FindJoint(model, spec).dof);
    }
  }
}

void ActiveEffects::Distort(std::span<double> readings, double time) noexcept {
  for (const auto& effect : effects_) effect->Distort(readings, time);
}

void ActiveEffects::Act(const mjModel& model, mjData& data) noexcept {
  Release(data);
  for (const auto& effect : effects_) {
    effect->Drive(model, data);
    effect->Push(model, data);
  }
}

void ActiveEffects::Release(mjData& data) noexcept {
  for (const int dof : dofs_) data.qfrc_applied[dof] = 0.0;
}

Channels WithEncoderNoise(Channels channels, const std::vector<EffectSpec>& effects) {
  for (const EffectSpec& spec : effects) {
    if (spec.effect != "encoder_noise") continue;
    for (SensorSetup& sensor : channels.sensors) {
      if (sensor.element != spec.site) continue;
      sensor.noise_sd = std::hypot(sensor.noise_sd, spec.Value("sd"));
    }
  }
  return channels;
}

}  // namespace mjdiag
