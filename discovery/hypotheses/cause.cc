#include "mjdiag/discovery/hypotheses/cause.h"

#include <array>
#include <cstdio>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

std::string Number(double value) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.4g", value);
  return digits.data();
}

/// The effect that does what a knob of one element does.
std::string EffectOf(KnobKind kind) {
  switch (kind) {
    case KnobKind::kDamping:
      return "viscous_friction";
    case KnobKind::kStiffness:
      return "structural_stiffness";
    case KnobKind::kGear:
      return "motor_constant";
  }
  return "";
}

bool IsTwin(const mjModel& model, const Cause& fault, const Cause& effect) {
  for (const FaultKnob& knob : FaultKnobs(model)) {
    if (knob.name == fault.spec.effect && knob.elements.size() == 1) {
      return EffectOf(knob.kind) == effect.spec.effect &&
             fault.spec.site == effect.spec.site;
    }
  }
  return false;
}

}  // namespace

Changes ChangesOf(const std::vector<Cause>& causes) {
  Changes changes;
  for (const Cause& cause : causes) {
    if (cause.fault) {
      changes.faults.push_back({cause.spec.effect, cause.spec.parameters.at("value")});
    } else {
      changes.effects.push_back(cause.spec);
    }
  }
  return changes;
}

Cause KnobCause(const mjModel& model, const FaultKnob& knob) {
  const mjtObj kind = knob.kind == KnobKind::kGear ? mjOBJ_ACTUATOR : mjOBJ_JOINT;
  std::string site;
  for (const int element : knob.elements) {
    site += (site.empty() ? "" : " ") + ElementName(model, kind, element);
  }
  return {{knob.name, site, {{"value", 1.0}}}, true};
}

std::string Describe(const Cause& cause) {
  if (cause.fault) {
    return cause.spec.effect + " = " + Number(cause.spec.parameters.at("value"));
  }
  std::string text = cause.spec.effect + "@" + cause.spec.site;
  const char* separator = ": ";
  for (const EffectParameter& parameter : FindEffect(cause.spec.effect).parameters) {
    text +=
        separator + parameter.name + " = " + Number(cause.spec.Value(parameter.name));
    separator = ", ";
  }
  return text;
}

bool SameKind(const Cause& a, const Cause& b) {
  return a.fault == b.fault && a.spec.effect == b.spec.effect &&
         a.spec.site == b.spec.site;
}

bool Indistinguishable(const mjModel& model, const Cause& a, const Cause& b) {
  if (SameKind(a, b)) return true;
  if (a.fault == b.fault) return false;
  return a.fault ? IsTwin(model, a, b) : IsTwin(model, b, a);
}

std::vector<Cause> Twins(const mjModel& model, const Cause& cause) {
  std::vector<Cause> twins;
  for (const FaultKnob& knob : FaultKnobs(model)) {
    if (knob.elements.size() != 1) continue;
    Cause fault = KnobCause(model, knob);
    Cause effect;
    effect.spec = {EffectOf(knob.kind), fault.spec.site, {}};
    const int joint = knob.elements.front();
    // Damping is added in N s/m, everything else scaled.
    const double damping = knob.kind == KnobKind::kDamping
                               ? model.dof_damping[model.jnt_dofadr[joint]]
                               : 0.0;
    const bool added = knob.kind == KnobKind::kDamping;
    const char* parameter = added ? "coefficient" : "factor";
    if (SameKind(cause, fault)) {
      const double value = cause.spec.parameters.at("value");
      effect.spec.parameters[parameter] = added ? (value - 1.0) * damping : value;
      twins.push_back(effect);
    } else if (SameKind(cause, effect)) {
      if (added && damping == 0.0) continue;
      const double value = cause.spec.parameters.at(parameter);
      fault.spec.parameters["value"] = added ? 1.0 + value / damping : value;
      twins.push_back(fault);
    }
  }
  return twins;
}

}  // namespace mjdiag
