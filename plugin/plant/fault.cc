#include "mjdiag/plugin/plant/fault.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kPrefix = "fault.";

PlantNumberKind ParseKind(const std::string& where, const std::string& word) {
  if (word == "damping") return PlantNumberKind::kDamping;
  if (word == "stiffness") return PlantNumberKind::kStiffness;
  if (word == "gear") return PlantNumberKind::kGear;
  throw InputError(where, "unknown kind of fault parameter \"" + word + "\"",
                   R"("damping" or "stiffness" and joints, or "gear" and actuators)");
}

FaultParameter ParseFaultParameter(const mjModel& model, const std::string& text_name,
                                   const std::string& data) {
  const std::string where = "custom text " + text_name;
  std::istringstream words(data);
  std::string word;
  words >> word;
  FaultParameter parameter{
      text_name.substr(kPrefix.size()), ParseKind(where, word), {}};
  const mjtObj target =
      parameter.kind == PlantNumberKind::kGear ? mjOBJ_ACTUATOR : mjOBJ_JOINT;
  while (words >> word) {
    try {
      parameter.elements.push_back(FindElement(model, target, word));
    } catch (const InputError& error) {
      throw InputError(where + ": " + error.what());
    }
  }
  if (parameter.elements.empty()) {
    throw InputError(where, "no element behind \"" + data + "\"",
                     "the names of joints or actuators");
  }
  return parameter;
}

FaultParameter FindFaultParameter(const mjModel& model, const std::string& name) {
  std::string known;
  for (FaultParameter& parameter : FaultParameters(model)) {
    if (parameter.name == name) return parameter;
    known += (known.empty() ? "" : ", ") + parameter.name;
  }
  throw InputError("fault " + name, "the plant declares no such fault parameter",
                   known.empty() ? "no fault" : "one of " + known);
}

/// change(values of one model, how many, those of another) for all that faults are of.
template <typename Change>
void ForEachFaultArray(const mjModel& from, mjModel& to, const Change& change) {
  change(from.dof_damping, from.nv, to.dof_damping);
  change(from.jnt_stiffness, from.njnt, to.jnt_stiffness);
  change(from.actuator_gear, 6 * from.nu, to.actuator_gear);
}

}  // namespace

std::vector<FaultParameter> FaultParameters(const mjModel& model) {
  std::vector<FaultParameter> parameters;
  for (int id = 0; id < model.ntext; ++id) {
    const std::string name = ElementName(model, mjOBJ_TEXT, id);
    if (!name.starts_with(kPrefix)) continue;
    parameters.push_back(
        ParseFaultParameter(model, name, model.text_data + model.text_adr[id]));
  }
  return parameters;
}

void ApplyFault(mjModel& model, const Fault& fault) {
  const FaultParameter parameter = FindFaultParameter(model, fault.name);
  if (!std::isfinite(fault.value) || fault.value < 0.0) {
    throw InputError("fault " + fault.name,
                     "value " + std::to_string(fault.value) + " is out of range",
                     "a finite number of at least 0");
  }
  for (const int element : parameter.elements) {
    Scale(model, {parameter.kind, element}, fault.value);
  }
}

void CopyFaults(const mjModel& from, mjModel& to) noexcept {
  ForEachFaultArray(from, to, [](const mjtNum* source, int count, mjtNum* values) {
    std::copy_n(source, count, values);
  });
}

void ApproachFaults(const mjModel& target, double part, mjModel& model) noexcept {
  ForEachFaultArray(target, model,
                    [part](const mjtNum* aim, int count, mjtNum* values) {
                      for (int i = 0; i < count; ++i)
                        values[i] += part * (aim[i] - values[i]);
                    });
}

}  // namespace mjdiag
