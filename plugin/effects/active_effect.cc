#include "mjdiag/plugin/effects/active_effect.h"

#include <cmath>

#include "mjdiag/plugin/effects/effect_factory.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

std::vector<EffectSpec> AllEffects(const mjModel& model,
                                   const std::vector<EffectSpec>& added) {
  std::vector<EffectSpec> all = EffectsOf(model);
  all.insert(all.end(), added.begin(), added.end());
  return all;
}

std::unique_ptr<ActiveEffect> Make(const Setup& setup, const mjModel& model,
                                   const EffectSpec& spec) {
  if (auto effect = MakeFrictionEffect(model, spec)) return effect;
  if (auto effect = MakeDriveEffect(model, spec)) return effect;
  if (auto effect = MakeStructureEffect(model, spec)) return effect;
  return MakeEncoderEffect(setup, spec);
}

}  // namespace

JointOf FindJoint(const mjModel& model, const EffectSpec& spec) {
  const int joint = FindElement(model, mjOBJ_JOINT, spec.site);
  const int position = model.jnt_qposadr[joint];
  return {model.jnt_dofadr[joint], position, model.qpos0[position]};
}

ActiveEffects::ActiveEffects(const Setup& setup, const mjModel& model,
                             const std::vector<EffectSpec>& added) {
  for (const EffectSpec& spec : AllEffects(model, added)) {
    CheckEffect(model, spec);
    auto effect = Make(setup, model, spec);
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

Setup WithEncoderNoise(const Setup& setup, const mjModel& model,
                       const std::vector<EffectSpec>& added) {
  Setup noisy = setup;
  for (const EffectSpec& spec : AllEffects(model, added)) {
    if (spec.effect != "encoder_noise") continue;
    for (SensorSetup& sensor : noisy.sensors) {
      if (sensor.element != spec.site) continue;
      sensor.noise_sd = std::hypot(sensor.noise_sd, spec.Value("sd"));
    }
  }
  return noisy;
}

}  // namespace mjdiag
