#include "mjdiag/plugin/plant/plant_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <string_view>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kDeclaration = "known";

struct KindOfNumber {
  std::string_view name;
  mjtObj element;
  double spread;  ///< UsualSpread
  double doubt;   ///< DoubtOf
};

constexpr double kFactorOfTwo = std::numbers::ln2;

/// In the order of PlantNumberKind.
constexpr std::array<KindOfNumber, 11> kKinds = {
    {{"mass", mjOBJ_BODY, 0.01, 0.05},
     {"inertia", mjOBJ_BODY, 0.03, 0.1},
     {"stiffness", mjOBJ_JOINT, 0.05, 0.1},
     {"damping", mjOBJ_JOINT, 0.2, kFactorOfTwo},
     {"friction", mjOBJ_JOINT, 0.2, kFactorOfTwo},
     {"gear", mjOBJ_ACTUATOR, 0.01, 0.05},
     {"armature", mjOBJ_JOINT, 0.05, 0.1},
     {"gain", mjOBJ_ACTUATOR, 0.03, 0.1},
     {"centre_x", mjOBJ_BODY, 0.03, 0.1},
     {"centre_y", mjOBJ_BODY, 0.03, 0.1},
     {"centre_z", mjOBJ_BODY, 0.03, 0.1}}};

const KindOfNumber& Of(PlantNumberKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

/// Degrees of freedom of a joint: three of a ball joint, six of a free one.
std::span<mjtNum> DofsOf(const mjModel& model, int joint, mjtNum* of_dof) {
  const int first = model.jnt_dofadr[joint];
  const int last =
      joint + 1 < model.njnt ? model.jnt_dofadr[joint + 1] : static_cast<int>(model.nv);
  return {of_dof + first, static_cast<std::size_t>(last - first)};
}

/// Where the number stands in the model, one place or two.
std::array<std::span<mjtNum>, 2> NumbersOf(const mjModel& model,
                                           const PlantNumber& number) {
  const int element = number.element;
  switch (number.kind) {
    case PlantNumberKind::kMass:
      return {{{model.body_mass + element, 1}}};
    case PlantNumberKind::kInertia:
      return {{{RowOf(model.body_inertia, 3, element), 3}}};
    case PlantNumberKind::kStiffness:
      return {{{model.jnt_stiffness + element, 1}}};
    case PlantNumberKind::kDamping:
      return {DofsOf(model, element, model.dof_damping)};
    case PlantNumberKind::kFriction:
      return {DofsOf(model, element, model.dof_frictionloss)};
    case PlantNumberKind::kGear:
      return {{{RowOf(model.actuator_gear, 6, element), 6}}};
    case PlantNumberKind::kArmature:
      return {DofsOf(model, element, model.dof_armature)};
    case PlantNumberKind::kGain:
      // Of a motor without a bias it is the gear.
      if (model.actuator_biastype[element] != mjBIAS_AFFINE) return {};
      return {{{RowOf(model.actuator_gainprm, mjNGAIN, element), mjNGAIN},
               {RowOf(model.actuator_biasprm, mjNBIAS, element), mjNBIAS}}};
    case PlantNumberKind::kCentreX:
    case PlantNumberKind::kCentreY:
    case PlantNumberKind::kCentreZ:
      break;  // none that is multiplied
  }
  return {};
}

/// Bodies that hang on a joint, their own or one further up.
bool Moves(const mjModel& model, int body) { return model.body_weldid[body] != 0; }

int AxisOf(PlantNumberKind kind) {
  return static_cast<int>(kind) - static_cast<int>(PlantNumberKind::kCentreX);
}

mjtNum& CentreOf(mjModel& model, const PlantNumber& number) {
  return RowOf(model.body_ipos, 3, number.element)[AxisOf(number.kind)];
}

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
  double of_all = -1.0;
};

Declarations DeclarationsOf(const mjModel& model, const PlantNumber& number) {
  const std::string name(kDeclaration);
  return {Declared(model, name + "." + PlantNumberName(model, number)),
          Declared(model, name)};
}

}  // namespace

std::string PlantNumberName(const mjModel& model, const PlantNumber& number) {
  const KindOfNumber& kind = Of(number.kind);
  return std::string(kind.name) + "@" +
         ElementName(model, kind.element, number.element);
}

PlantNumber FindPlantNumber(const mjModel& model, const std::string& name) {
  const auto at = name.find('@');
  const std::string word = name.substr(0, at);
  const auto kind =
      std::find_if(kKinds.begin(), kKinds.end(),
                   [&](const KindOfNumber& known) { return known.name == word; });
  if (kind == kKinds.end() || at == std::string::npos) {
    throw InputError("plant number '" + name + "'", "is of no known kind",
                     "mass@ or inertia@ a body, stiffness@, damping@, friction@ or "
                     "armature@ a joint, gear@ or gain@ an actuator");
  }
  return {static_cast<PlantNumberKind>(kind - kKinds.begin()),
          FindElement(model, kind->element, name.substr(at + 1))};
}

std::vector<PlantNumber> PlantNumbers(const mjModel& model) {
  std::vector<PlantNumber> numbers;
  const auto add = [&](PlantNumberKind kind, int count) {
    for (int element = 0; element < count; ++element) {
      const PlantNumber number{kind, element};
      const bool of_body = Of(kind).element == mjOBJ_BODY;
      if (of_body && !Moves(model, element)) continue;
      for (const auto values : NumbersOf(model, number)) {
        if (std::ranges::all_of(values, [](double value) { return value == 0.0; })) {
          continue;
        }
        numbers.push_back(number);
        break;
      }
    }
  };
  add(PlantNumberKind::kMass, model.nbody);
  add(PlantNumberKind::kInertia, model.nbody);
  add(PlantNumberKind::kStiffness, model.njnt);
  add(PlantNumberKind::kDamping, model.njnt);
  add(PlantNumberKind::kFriction, model.njnt);
  add(PlantNumberKind::kGear, model.nu);
  add(PlantNumberKind::kArmature, model.njnt);
  add(PlantNumberKind::kGain, model.nu);
  return numbers;
}

bool IsCentre(PlantNumberKind kind) { return kind >= PlantNumberKind::kCentreX; }

std::vector<PlantNumber> CentreNumbers(const mjModel& model) {
  std::vector<PlantNumber> numbers;
  for (int body = 0; body < model.nbody; ++body) {
    if (!Moves(model, body) || model.body_mass[body] == 0.0) continue;
    for (const auto kind : {PlantNumberKind::kCentreX, PlantNumberKind::kCentreY,
                            PlantNumberKind::kCentreZ}) {
      const PlantNumber number{kind, body};
      if (CentreUnit(model, number) > 0.0) numbers.push_back(number);
    }
  }
  return numbers;
}

double CentreUnit(const mjModel& model, const PlantNumber& number) {
  const mjtNum* inertia = RowOf(model.body_inertia, 3, number.element);
  const double trace = inertia[0] + inertia[1] + inertia[2];
  return std::sqrt(trace / (2.0 * model.body_mass[number.element]));
}

std::vector<PlantNumber> PlantNumbersOf(const mjModel& model, const std::string& text) {
  std::vector<PlantNumber> meant = PlantNumbers(model);
  std::ranges::copy(CentreNumbers(model), std::back_inserter(meant));
  std::erase_if(meant, [&](const PlantNumber& number) {
    return text != "all" && text != Of(number.kind).name &&
           text != PlantNumberName(model, number);
  });
  if (meant.empty()) {
    throw InputError(
        "number of the plant '" + text + "'", "there is none",
        "all, a kind (mass, inertia, stiffness, damping, friction, gear) or "
        "one of an element, as mass@<body>");
  }
  return meant;
}

double UsualSpread(PlantNumberKind kind) { return Of(kind).spread; }

double SpreadOf(const mjModel& model, const PlantNumber& number) {
  const Declarations declared = DeclarationsOf(model, number);
  if (declared.own >= 0.0) return declared.own;
  return declared.of_all >= 0.0 ? declared.of_all : UsualSpread(number.kind);
}

double DoubtOf(const mjModel& model, const PlantNumber& number) {
  const Declarations declared = DeclarationsOf(model, number);
  if (declared.own > 0.0) return declared.own;
  return declared.of_all > 0.0 ? declared.of_all : Of(number.kind).doubt;
}

bool IsExact(const mjModel& model) {
  return Declared(model, std::string(kDeclaration)) == 0.0;
}

void Scale(mjModel& model, const PlantNumber& number, double factor) {
  if (IsCentre(number.kind)) {
    CentreOf(model, number) += std::log(factor) * CentreUnit(model, number);
    return;
  }
  for (const auto values : NumbersOf(model, number)) {
    for (mjtNum& value : values) value *= factor;
  }
}

void ScaleNumbers(mjModel& model, const NumberFactors& factors) {
  if (factors.empty()) return;
  for (const auto& [number, factor] : factors) Scale(model, number, factor);
  DeriveConstants(model);
}

void SetNumber(mjModel& model, const mjModel& nominal, const PlantNumber& number,
               double factor) {
  if (IsCentre(number.kind)) {
    CentreOf(model, number) =
        RowOf(nominal.body_ipos, 3, number.element)[AxisOf(number.kind)];
    Scale(model, number, factor);
    return;
  }
  const auto all = NumbersOf(nominal, number);
  const auto changed = NumbersOf(model, number);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::ranges::transform(all[i], changed[i].begin(),
                           [&](double value) { return factor * value; });
  }
}

void DeriveConstants(mjModel& model) {
  const DataPtr data = MakeData(model);
  mj_setConst(&model, data.get());
}

}  // namespace mjdiag
