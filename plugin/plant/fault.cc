#include "mjdiag/plugin/plant/fault.h"

#include <cmath>
#include <sstream>
#include <string_view>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kPrefix = "fault.";

KnobKind ParseKind(const std::string& knob, const std::string& word) {
  if (word == "damping") return KnobKind::kDamping;
  if (word == "stiffness") return KnobKind::kStiffness;
  if (word == "gear") return KnobKind::kGear;
  throw InputError(
      knob, "unknown kind of knob \"" + word + "\"",
      "\"damping\" or \"stiffness\" and joints, or \"gear\" and actuators");
}

FaultKnob ParseKnob(const mjModel& model, const std::string& text_name,
                    const std::string& data) {
  const std::string where = "custom text " + text_name;
  std::istringstream words(data);
  std::string word;
  words >> word;
  FaultKnob knob{text_name.substr(kPrefix.size()), ParseKind(where, word), {}};
  const mjtObj target = knob.kind == KnobKind::kGear ? mjOBJ_ACTUATOR : mjOBJ_JOINT;
  while (words >> word) {
    try {
      knob.elements.push_back(FindElement(model, target, word));
    } catch (const InputError& error) {
      throw InputError(where + ": " + error.what());
    }
  }
  if (knob.elements.empty()) {
    throw InputError(where, "no element behind \"" + data + "\"",
                     "the names of joints or actuators");
  }
  return knob;
}

FaultKnob FindKnob(const mjModel& model, const std::string& name) {
  std::string known;
  for (FaultKnob& knob : FaultKnobs(model)) {
    if (knob.name == name) return knob;
    known += (known.empty() ? "" : ", ") + knob.name;
  }
  throw InputError("fault " + name, "the plant declares no such knob",
                   known.empty() ? "no fault" : "one of " + known);
}

void Scale(mjModel& model, KnobKind kind, int element, double factor) {
  switch (kind) {
    case KnobKind::kDamping: {
      // A ball joint has three degrees of freedom, a free joint six.
      const int first = model.jnt_dofadr[element];
      const int last = element + 1 < model.njnt ? model.jnt_dofadr[element + 1]
                                                : static_cast<int>(model.nv);
      mju_scl(model.dof_damping + first, model.dof_damping + first, factor,
              last - first);
      return;
    }
    case KnobKind::kStiffness:
      model.jnt_stiffness[element] *= factor;
      return;
    case KnobKind::kGear:
      mju_scl(model.actuator_gear + 6 * element, model.actuator_gear + 6 * element,
              factor, 6);
      return;
  }
}

}  // namespace

std::vector<FaultKnob> FaultKnobs(const mjModel& model) {
  std::vector<FaultKnob> knobs;
  for (int id = 0; id < model.ntext; ++id) {
    const std::string name = ElementName(model, mjOBJ_TEXT, id);
    if (!name.starts_with(kPrefix)) continue;
    knobs.push_back(ParseKnob(model, name, model.text_data + model.text_adr[id]));
  }
  return knobs;
}

void ApplyFault(mjModel& model, const Fault& fault) {
  const FaultKnob knob = FindKnob(model, fault.name);
  if (!std::isfinite(fault.value) || fault.value < 0.0) {
    throw InputError("fault " + fault.name,
                     "value " + std::to_string(fault.value) + " is out of range",
                     "a finite number of at least 0");
  }
  for (const int element : knob.elements) {
    Scale(model, knob.kind, element, fault.value);
  }
}

}  // namespace mjdiag
