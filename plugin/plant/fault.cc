#include "mjdiag/plugin/plant/fault.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kPrefix = "fault.";

ModelParameterKind ParseKind(const std::string& where, const std::string& word) {
  const auto kind = FindKind(word);
  if (kind && !IsAdditive(*kind)) return *kind;
  throw InputError(where, "unknown kind of fault parameter \"" + word + "\"",
                   "one of " + AllKinds(false) + ", with the names of such elements");
}

FaultParameter ParseFaultParameter(const mjModel& model, const std::string& text_name,
                                   const std::string& data) {
  const std::string where = "custom text " + text_name;
  std::istringstream words(data);
  std::string word;
  words >> word;
  const ModelParameterKind kind = ParseKind(where, word);
  FaultParameter parameter{text_name.substr(kPrefix.size()), kind, {}};
  const std::string of_kind = word + "@";
  while (words >> word) {
    try {
      parameter.elements.push_back(FindModelParameter(model, of_kind + word).element);
    } catch (const InputError& error) {
      throw InputError(where + ": " + error.what());
    }
  }
  if (parameter.elements.empty()) {
    throw InputError(where, "no element behind \"" + data + "\"",
                     std::string("the name of a ") + mju_type2Str(ElementOf(kind)));
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
  change(from.dof_frictionloss, from.nv, to.dof_frictionloss);
  change(from.dof_armature, from.nv, to.dof_armature);
  change(from.jnt_stiffness, from.njnt, to.jnt_stiffness);
  change(from.actuator_gear, 6 * from.nu, to.actuator_gear);
  change(from.actuator_gainprm, mjNGAIN * from.nu, to.actuator_gainprm);
  change(from.actuator_biasprm, mjNBIAS * from.nu, to.actuator_biasprm);
  change(from.tendon_stiffness, from.ntendon, to.tendon_stiffness);
  change(from.tendon_damping, from.ntendon, to.tendon_damping);
  change(from.tendon_frictionloss, from.ntendon, to.tendon_frictionloss);
  change(from.body_mass, from.nbody, to.body_mass);
  change(from.body_inertia, 3 * from.nbody, to.body_inertia);
}

/// What MuJoCo derives from masses and rotors.
template <typename Change>
void ForEachDerivedArray(const mjModel& from, mjModel& to, const Change& change) {
  change(from.body_subtreemass, from.nbody, to.body_subtreemass);
  change(from.body_invweight0, 2 * from.nbody, to.body_invweight0);
  change(from.dof_M0, from.nv, to.dof_M0);
  change(from.dof_invweight0, from.nv, to.dof_invweight0);
  change(from.tendon_invweight0, from.ntendon, to.tendon_invweight0);
  change(from.actuator_acc0, from.nu, to.actuator_acc0);
  change(&from.stat.meanmass, 1, &to.stat.meanmass);
  change(&from.stat.meaninertia, 1, &to.stat.meaninertia);
}

template <typename Change>
void ForEachArray(const mjModel& from, mjModel& to, const Change& change) {
  ForEachFaultArray(from, to, change);
  ForEachDerivedArray(from, to, change);
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
  if (IsDerivedFrom(parameter.kind)) DeriveConstants(model);
}

void CopyFaults(const mjModel& from, mjModel& to) noexcept {
  ForEachArray(from, to, [](const mjtNum* source, int count, mjtNum* values) {
    std::copy_n(source, count, values);
  });
}

void ApproachFaults(const mjModel& target, double part, mjModel& model) noexcept {
  ForEachArray(target, model, [part](const mjtNum* aim, int count, mjtNum* values) {
    for (int i = 0; i < count; ++i) values[i] += part * (aim[i] - values[i]);
  });
}

}  // namespace mjdiag
