#include "mjdiag/plugin/effects/native_effect.h"

#include <algorithm>
#include <functional>
#include <map>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Change = std::function<void(mjModel&, int site, const EffectSpec&)>;

[[noreturn]] void FailTooMuch(const EffectSpec& effect, const char* what) {
  throw InputError("effect " + effect.effect + "@" + effect.site,
                   std::string("takes away more ") + what + " than there is",
                   "a smaller value");
}

void AddFriction(mjModel& model, int joint, double force) {
  const int dof = model.jnt_dofadr[joint];
  model.dof_frictionloss[dof] += force;
  StiffenFriction(model, dof);
}

void AddCoulombFriction(mjModel& model, int joint, const EffectSpec& effect) {
  AddFriction(model, joint, effect.Value("force"));
}

// MuJoCo makes no constraint of a bound of zero, and the active part needs one.
void AddStribeckFriction(mjModel& model, int joint, const EffectSpec& effect) {
  AddFriction(model, joint, std::max(effect.Value("coulomb"), 1e-12));
}

void AddViscousFriction(mjModel& model, int joint, const EffectSpec& effect) {
  mjtNum& damping = model.dof_damping[model.jnt_dofadr[joint]];
  damping += effect.Value("coefficient");
  if (damping < 0.0) FailTooMuch(effect, "damping");
}

void AddSpring(mjModel& model, int joint, const EffectSpec& effect) {
  const int address = model.jnt_qposadr[joint];
  const double added = effect.Value("stiffness");
  const double before = model.jnt_stiffness[joint];
  mjtNum& reference = model.qpos_spring[address];
  if (before + added != 0.0) {
    reference = (before * reference + added * model.qpos0[address]) / (before + added);
  }
  model.jnt_stiffness[joint] = before + added;
}

void ScaleSpring(mjModel& model, int joint, const EffectSpec& effect) {
  model.jnt_stiffness[joint] *= effect.Value("factor");
}

void AddMass(mjModel& model, int joint, const EffectSpec& effect) {
  const double mass = effect.Value("mass");
  if (model.jnt_type[joint] == mjJNT_HINGE) {
    const int dof = model.jnt_dofadr[joint];
    // dof_M0 is the inertia at qpos0, armature included.
    if (model.dof_M0[dof] + mass <= 0.0) FailTooMuch(effect, "inertia");
    model.dof_armature[dof] += mass;
  } else {
    mjtNum& body = model.body_mass[model.jnt_bodyid[joint]];
    if (body + mass <= 0.0) FailTooMuch(effect, "mass");
    body += mass;
  }
  // What MuJoCo derives from masses when it compiles.
  const DataPtr data = MakeData(model);
  mj_setConst(&model, data.get());
}

void ScaleMotor(mjModel& model, int actuator, const EffectSpec& effect) {
  mjtNum* gear = model.actuator_gear + 6 * actuator;
  std::for_each(gear, gear + 6, [&](mjtNum& g) { g *= effect.Value("factor"); });
}

void LimitMotor(mjModel& model, int actuator, const EffectSpec& effect) {
  mjtNum* range = model.actuator_forcerange + 2 * actuator;
  const double limit = effect.Value("limit");
  const bool limited = model.actuator_forcelimited[actuator] != 0;
  range[0] = limited ? std::max(range[0], -limit) : -limit;
  range[1] = limited ? std::min(range[1], limit) : limit;
  model.actuator_forcelimited[actuator] = 1;
}

const std::map<std::string, Change>& Changes() {
  static const std::map<std::string, Change> changes{
      {"coulomb_friction", AddCoulombFriction},
      {"viscous_friction", AddViscousFriction},
      {"stribeck_friction", AddStribeckFriction},
      {"linear_stiffness", AddSpring},
      {"structural_stiffness", ScaleSpring},
      {"added_mass", AddMass},
      {"motor_constant", ScaleMotor},
      {"force_saturation", LimitMotor}};
  return changes;
}

}  // namespace

void StiffenFriction(mjModel& model, int dof) {
  mjtNum* solref = model.dof_solref + mjNREF * dof;
  solref[0] = 2.0 * model.opt.timestep;
  solref[1] = 1.0;
  mjtNum* solimp = model.dof_solimp + mjNIMP * dof;
  solimp[0] = 0.99;
  solimp[1] = 0.999;
  solimp[2] = 1e-4;
}

void ApplyNativeEffect(mjModel& model, const EffectSpec& effect) {
  const int site = CheckEffect(model, effect);
  const auto change = Changes().find(effect.effect);
  if (change != Changes().end()) change->second(model, site, effect);
}

}  // namespace mjdiag
