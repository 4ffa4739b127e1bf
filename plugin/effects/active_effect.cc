#include "mjdiag/plugin/effects/active_effect.h"

#include <algorithm>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/plant/motor_force.h"

namespace mjdiag {

ActiveEffects::ActiveEffects(const Channels& channels, const mjModel& model,
                             const std::vector<PlacedEffect>& effects)
    : damping_(static_cast<std::size_t>(model.nv)) {
  for (const PlacedEffect& placed : effects) {
    const int element = CheckEffect(model, placed);
    auto active = placed.effect->Activate(model, channels, element, placed.values);
    if (!active) continue;
    effects_.push_back(std::move(active));
    const bool at_joint = placed.effect->element() == mjOBJ_JOINT;
    dof_of_.push_back(at_joint ? model.jnt_dofadr[element] : -1);
    if (!at_joint) continue;
    dofs_.push_back(dof_of_.back());
    CarriedBody* body = effects_.back()->Body();
    if (body == nullptr) continue;
    const std::string name = placed.effect->name() + "@" + placed.site;
    const auto before = std::ranges::count_if(
        bodies_, [&](const BodyOf& one) { return one.effect == name; });
    bodies_.push_back({name, static_cast<int>(before), dof_of_.back(), body});
  }
}

void ActiveEffects::Distort(const mjModel& model, const mjData& data,
                            std::span<double> readings, double time) noexcept {
  for (const auto& effect : effects_) effect->Distort(model, data, readings, time);
}

void ActiveEffects::Act(const mjModel& model, mjData& data,
                        std::span<const int> off) noexcept {
  Release(data);
  for (const auto& effect : effects_) effect->Drive(model, data);
  for (const int motor : off) data.ctrl[motor] = OpenCircuitCommand(model, data, motor);
  Damp(model, data);
  for (const auto& effect : effects_) effect->Push(model, data);
  for (const auto& effect : effects_) effect->Bind(model, data);
}

bool ActiveEffects::FollowTheirJoints() const {
  if (!bodies_.empty()) return false;
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    if (dof_of_[i] >= 0 && !effects_[i]->FollowsItsJoint()) return false;
  }
  return true;
}

void ActiveEffects::PushInto(const mjModel& model, mjData& data,
                             std::span<double> forces) noexcept {
  Release(data);
  Damp(model, data);
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    if (dof_of_[i] >= 0) effects_[i]->Push(model, data);
  }
  std::ranges::fill(forces, 0.0);
  for (const int dof : dofs_) {
    forces[static_cast<std::size_t>(dof)] = data.qfrc_applied[dof];
  }
  Release(data);
}

void ActiveEffects::Damp(const mjModel& model, mjData& data) noexcept {
  for (const int dof : dofs_) damping_[static_cast<std::size_t>(dof)] = 0.0;
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    if (dof_of_[i] < 0) continue;
    damping_[static_cast<std::size_t>(dof_of_[i])] += effects_[i]->Damping(model, data);
  }
  for (const int dof : dofs_) {
    // Set to nothing once it is done: a joint may be there several times.
    double& added = damping_[static_cast<std::size_t>(dof)];
    const double has = std::max(0.0, model.dof_damping[dof]);
    data.qfrc_applied[dof] -= std::max(added, -has) * data.qvel[dof];
    added = 0.0;
  }
}

void ActiveEffects::Release(mjData& data) noexcept {
  for (const int dof : dofs_) data.qfrc_applied[dof] = 0.0;
}

void ActiveEffects::Recall(const ActiveEffects& other) noexcept {
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    effects_[i]->Recall(*other.effects_[i]);
  }
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
