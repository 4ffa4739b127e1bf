#include "mjdiag/plugin/plant/model_parameter.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kDeclaration = "known";

/// Bodies that hang on a joint, their own or one further up.
bool Moves(const mjModel& model, int body) { return model.body_weldid[body] != 0; }

/// -1: not declared.
double Declared(const mjModel& model, const std::string& name) {
  const int id = mj_name2id(&model, mjOBJ_NUMERIC, name.c_str());
  if (id < 0) return -1.0;
  const double spread = model.numeric_data[model.numeric_adr[id]];
  if (model.numeric_size[id] != 1 || !std::isfinite(spread) || spread < 0.0) {
    throw InputError("custom numeric " + name, "is " + std::to_string(spread),
                     "one relative standard deviation >= 0");
  }
  return spread;
}

/// What a plant declares of a number itself, and of all that it does not.
struct Declarations {
  double own = -1.0;
  double of_kind = -1.0;
  double of_all = -1.0;
  /// That which says most of it; -1: none.
  double Closest() const {
    return own >= 0.0 ? own : of_kind >= 0.0 ? of_kind : of_all;
  }
};

Declarations DeclarationsOf(const mjModel& model, const ModelParameter& number) {
  const std::string name(kDeclaration);
  Declarations declared{Declared(model, name + "." + ModelParameterName(model, number)),
                        Declared(model, name + "." + std::string(WordOf(number.kind))),
                        Declared(model, name)};
  // No part of anything, it is known to a distance of its own.
  if (number.kind == ModelParameterKind::kRef && declared.of_all > 0.0) {
    declared.of_all = -1.0;
  }
  return declared;
}

int CountOf(const mjModel& model, mjtObj element) {
  switch (element) {
    case mjOBJ_BODY:
      return static_cast<int>(model.nbody);
    case mjOBJ_JOINT:
      return static_cast<int>(model.njnt);
    case mjOBJ_ACTUATOR:
      return static_cast<int>(model.nu);
    default:
      return static_cast<int>(model.ntendon);
  }
}

/// Whether an element has such a number that is not 0, and no other one does the same.
bool IsInDoubt(const mjModel& model, const ModelParameter& number) {
  const auto has = [&](ModelParameterKind kind) {
    return HasNumber(model, {kind, number.element});
  };
  if (!HasNumber(model, number)) return false;
  switch (number.kind) {
    case ModelParameterKind::kMass:
    case ModelParameterKind::kInertia:
      if (!Moves(model, number.element)) return false;
      break;
    case ModelParameterKind::kGain:
      if (has(ModelParameterKind::kKp) || !has(ModelParameterKind::kKv)) return false;
      break;
    case ModelParameterKind::kKv:
      if (!has(ModelParameterKind::kKp)) return false;
      break;
    case ModelParameterKind::kRef:
      return DeclarationsOf(model, number).own > 0.0;
    default:
      break;
  }
  return ValueOf(model, number) != 0.0;
}

std::vector<ModelParameter> References(const mjModel& model) {
  std::vector<ModelParameter> numbers;
  for (int joint = 0; joint < model.njnt; ++joint) {
    const ModelParameter number{ModelParameterKind::kRef, joint};
    if (HasNumber(model, number)) numbers.push_back(number);
  }
  return numbers;
}

/// What an element needs to have such a number.
const char* Condition(ModelParameterKind kind) {
  switch (kind) {
    case ModelParameterKind::kGain:
      return "an actuator with an affine bias; of others it is gear@";
    case ModelParameterKind::kKp:
      return "an actuator that feeds back its position, biasprm[1] other than 0";
    case ModelParameterKind::kKv:
      return "an actuator that feeds back its velocity, biasprm[2] other than 0";
    case ModelParameterKind::kRef:
      return "a hinge or a slide";
    default:
      return "a body with a mass and an inertia";
  }
}

}  // namespace

std::string ModelParameterName(const mjModel& model, const ModelParameter& number) {
  return std::string(WordOf(number.kind)) + "@" +
         ElementName(model, ElementOf(number.kind), number.element);
}

ModelParameter FindModelParameter(const mjModel& model, const std::string& name) {
  const auto at = name.find('@');
  const auto kind = FindKind(std::string_view(name).substr(0, at));
  if (!kind || at == std::string::npos) {
    throw InputError("plant number '" + name + "'", "is of no known kind", AllKinds());
  }
  const ModelParameter number{
      *kind, FindElement(model, ElementOf(*kind), name.substr(at + 1))};
  if (!HasNumber(model, number)) {
    throw InputError("plant number '" + name + "'", "is none of that element",
                     Condition(*kind));
  }
  return number;
}

std::vector<ModelParameter> ModelParameters(const mjModel& model) {
  std::vector<ModelParameter> numbers;
  const auto add = [&](ModelParameterKind kind) {
    for (int element = 0; element < CountOf(model, ElementOf(kind)); ++element) {
      const ModelParameter number{kind, element};
      if (IsInDoubt(model, number)) numbers.push_back(number);
    }
  };
  add(ModelParameterKind::kMass);
  add(ModelParameterKind::kInertia);
  add(ModelParameterKind::kStiffness);
  add(ModelParameterKind::kDamping);
  add(ModelParameterKind::kFriction);
  add(ModelParameterKind::kGear);
  add(ModelParameterKind::kArmature);
  add(ModelParameterKind::kGain);
  add(ModelParameterKind::kKp);
  add(ModelParameterKind::kKv);
  add(ModelParameterKind::kTendonStiffness);
  add(ModelParameterKind::kTendonDamping);
  add(ModelParameterKind::kTendonFriction);
  add(ModelParameterKind::kRef);
  return numbers;
}

std::vector<ModelParameter> CentreNumbers(const mjModel& model) {
  std::vector<ModelParameter> numbers;
  for (int body = 0; body < model.nbody; ++body) {
    if (!Moves(model, body)) continue;
    for (const auto kind : {ModelParameterKind::kCentreX, ModelParameterKind::kCentreY,
                            ModelParameterKind::kCentreZ}) {
      const ModelParameter number{kind, body};
      if (HasNumber(model, number)) numbers.push_back(number);
    }
  }
  return numbers;
}

std::vector<ModelParameter> ModelParametersOf(const mjModel& model,
                                              const std::string& text) {
  std::vector<ModelParameter> meant = ModelParameters(model);
  std::ranges::copy(CentreNumbers(model), std::back_inserter(meant));
  std::erase_if(meant, [&](const ModelParameter& number) {
    return text != "all" && text != WordOf(number.kind) &&
           text != ModelParameterName(model, number);
  });
  if (text == WordOf(ModelParameterKind::kRef)) meant = References(model);
  if (meant.empty() && text.find('@') != std::string::npos) {
    const ModelParameter number = FindModelParameter(model, text);
    if (IsAdditive(number.kind) || ValueOf(model, number) != 0.0) return {number};
    throw InputError("number of the plant '" + text + "'", "is 0", "one that is not 0");
  }
  if (meant.empty()) {
    throw InputError("number of the plant '" + text + "'", "there is none",
                     "all, a kind or one of an element: " + AllKinds());
  }
  return meant;
}

double SpreadOf(const mjModel& model, const ModelParameter& number) {
  const double declared = DeclarationsOf(model, number).Closest();
  return declared >= 0.0 ? declared : UsualSpread(number.kind);
}

double DoubtOf(const mjModel& model, const ModelParameter& number) {
  const double declared = DeclarationsOf(model, number).Closest();
  return declared > 0.0 ? declared : UsualDoubt(number.kind);
}

bool IsExact(const mjModel& model) {
  return Declared(model, std::string(kDeclaration)) == 0.0;
}

void CheckKnownNumbers(const mjModel& model) {
  const std::string prefix = std::string(kDeclaration) + ".";
  for (int id = 0; id < model.nnumeric; ++id) {
    const std::string name = ElementName(model, mjOBJ_NUMERIC, id);
    if (!name.starts_with(prefix)) continue;
    if (FindKind(name.substr(prefix.size()))) {
      Declared(model, name);
      continue;
    }
    try {
      SpreadOf(model, FindModelParameter(model, name.substr(prefix.size())));
    } catch (const InputError& error) {
      throw InputError("custom numeric " + name + ": " + error.what());
    }
  }
}

}  // namespace mjdiag
