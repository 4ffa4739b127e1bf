#include "mjdiag/plugin/plant/scale_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Places = std::array<std::span<mjtNum>, 2>;

/// Degrees of freedom of a joint: three of a ball joint, six of a free one.
std::span<mjtNum> DofsOf(const mjModel& model, int joint, mjtNum* of_dof) {
  const int first = model.jnt_dofadr[joint];
  const int last =
      joint + 1 < model.njnt ? model.jnt_dofadr[joint + 1] : static_cast<int>(model.nv);
  return {of_dof + first, static_cast<std::size_t>(last - first)};
}

std::span<mjtNum> GainOf(const mjModel& model, int actuator) {
  return {RowOf(model.actuator_gainprm, mjNGAIN, actuator), mjNGAIN};
}

std::span<mjtNum> BiasOf(const mjModel& model, int actuator) {
  return {RowOf(model.actuator_biasprm, mjNBIAS, actuator), mjNBIAS};
}

bool HasAffineBias(const mjModel& model, int actuator) {
  return model.actuator_biastype[actuator] == mjBIAS_AFFINE;
}

/// Of an affine bias: force by length and by velocity.
constexpr std::size_t kOfLength = 1;
constexpr std::size_t kOfVelocity = 2;

bool FeedsBack(const mjModel& model, int actuator, std::size_t of) {
  return HasAffineBias(model, actuator) && BiasOf(model, actuator)[of] != 0.0;
}

/// Whether an actuator has the number at all, be it 0.
bool ActuatorHas(const mjModel& model, const ModelParameter& number) {
  switch (number.kind) {
    case ModelParameterKind::kGain:
      return HasAffineBias(model, number.element);  // else it is the gear
    case ModelParameterKind::kKp:
      return FeedsBack(model, number.element, kOfLength);
    case ModelParameterKind::kKv:
      return FeedsBack(model, number.element, kOfVelocity);
    default:
      return true;
  }
}

/// Where a number that is multiplied would stand in the model, one place or two.
Places PlacesOf(const mjModel& model, const ModelParameter& number) {
  const int element = number.element;
  switch (number.kind) {
    case ModelParameterKind::kMass:
      return {{{model.body_mass + element, 1}}};
    case ModelParameterKind::kInertia:
      return {{{RowOf(model.body_inertia, 3, element), 3}}};
    case ModelParameterKind::kStiffness:
      return {{{model.jnt_stiffness + element, 1}}};
    case ModelParameterKind::kDamping:
      return {DofsOf(model, element, model.dof_damping)};
    case ModelParameterKind::kFriction:
      return {DofsOf(model, element, model.dof_frictionloss)};
    case ModelParameterKind::kGear:
      return {{{RowOf(model.actuator_gear, 6, element), 6}}};
    case ModelParameterKind::kArmature:
      return {DofsOf(model, element, model.dof_armature)};
    case ModelParameterKind::kGain:
      return {GainOf(model, element), BiasOf(model, element)};
    case ModelParameterKind::kKp:
      return {GainOf(model, element), BiasOf(model, element).subspan(kOfLength, 1)};
    case ModelParameterKind::kKv:
      return {BiasOf(model, element).subspan(kOfVelocity, 1)};
    case ModelParameterKind::kTendonStiffness:
      return {{{model.tendon_stiffness + element, 1}}};
    case ModelParameterKind::kTendonDamping:
      return {{{model.tendon_damping + element, 1}}};
    case ModelParameterKind::kTendonFriction:
      return {{{model.tendon_frictionloss + element, 1}}};
    case ModelParameterKind::kCentreX:
    case ModelParameterKind::kCentreY:
    case ModelParameterKind::kCentreZ:
    case ModelParameterKind::kRef:
      break;  // none that is multiplied
  }
  return {};
}

bool IsScalar(const mjModel& model, int joint) {
  return model.jnt_type[joint] == mjJNT_SLIDE || model.jnt_type[joint] == mjJNT_HINGE;
}

int AxisOf(ModelParameterKind kind) {
  return static_cast<int>(kind) - static_cast<int>(ModelParameterKind::kCentreX);
}

/// Where a number that is additive stands.
mjtNum& PlaceOf(const mjModel& model, const ModelParameter& number) {
  if (number.kind == ModelParameterKind::kRef) {
    return model.qpos0[model.jnt_qposadr[number.element]];
  }
  return RowOf(model.body_ipos, 3, number.element)[AxisOf(number.kind)];
}

/// Lengths of all tendons in the configuration in which springs rest.
std::vector<mjtNum> LengthsOfSprings(const mjModel& model, mjData& data) {
  std::copy_n(model.qpos_spring, model.nq, data.qpos);
  mj_kinematics(&model, &data);
  mj_comPos(&model, &data);
  mj_tendon(&model, &data);
  return {data.ten_length, data.ten_length + model.ntendon};
}

/// Of a tendon that says no length of its own, the compiler takes the one there.
class MeasuredLengths {
 public:
  explicit MeasuredLengths(const mjModel& model) : data_(MakeData(model)) {
    const std::vector<mjtNum> lengths = LengthsOfSprings(model, *data_);
    for (int tendon = 0; tendon < model.ntendon; ++tendon) {
      if (lengths[static_cast<std::size_t>(tendon)] ==
          model.tendon_lengthspring[tendon]) {
        measured_.push_back(tendon);
      }
    }
  }
  void MeasureAgain(mjModel& model) {
    const std::vector<mjtNum> lengths = LengthsOfSprings(model, *data_);
    for (const int tendon : measured_) {
      model.tendon_lengthspring[tendon] = lengths[static_cast<std::size_t>(tendon)];
    }
  }

 private:
  DataPtr data_;
  std::vector<int> measured_;
};

bool MovesReferences(const mjModel& model, const NumberFactors& factors) {
  return model.ntendon > 0 && std::ranges::any_of(factors, [](const auto& factor) {
           return factor.first.kind == ModelParameterKind::kRef;
         });
}

}  // namespace

void Scale(mjModel& model, const ModelParameter& number, double factor) noexcept {
  if (IsAdditive(number.kind)) {
    PlaceOf(model, number) += std::log(factor) * UnitOf(model, number);
    return;
  }
  if (!HasNumber(model, number)) return;
  for (const auto values : PlacesOf(model, number)) {
    for (mjtNum& value : values) value *= factor;
  }
}

void ScaleNumbers(mjModel& model, const NumberFactors& factors) {
  if (factors.empty()) return;
  std::optional<MeasuredLengths> tendons;
  if (MovesReferences(model, factors)) tendons.emplace(model);
  for (const auto& [number, factor] : factors) Scale(model, number, factor);
  if (tendons) tendons->MeasureAgain(model);
  DeriveConstants(model);
}

void SetNumber(mjModel& model, const mjModel& nominal, const ModelParameter& number,
               double factor) noexcept {
  if (IsAdditive(number.kind)) {
    PlaceOf(model, number) =
        PlaceOf(nominal, number) + std::log(factor) * UnitOf(nominal, number);
    return;
  }
  if (!HasNumber(nominal, number)) return;
  const Places all = PlacesOf(nominal, number);
  const Places changed = PlacesOf(model, number);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::ranges::transform(all[i], changed[i].begin(),
                           [&](double value) { return factor * value; });
  }
}

void DeriveConstants(mjModel& model) {
  // MuJoCo would put what it measures of the geometry in the place of what the file says.
  const mjStatistic said = model.stat;
  const DataPtr data = MakeData(model);
  mj_setConst(&model, data.get());
  model.stat.extent = said.extent;
  model.stat.meansize = said.meansize;
  std::ranges::copy(said.center, model.stat.center);
}

bool HasNumber(const mjModel& model, const ModelParameter& number) {
  if (number.kind == ModelParameterKind::kRef) return IsScalar(model, number.element);
  if (IsAdditive(number.kind)) {
    return model.body_mass[number.element] > 0.0 && UnitOf(model, number) > 0.0;
  }
  return !IsDrive(number.kind) || ActuatorHas(model, number);
}

double UnitOf(const mjModel& model, const ModelParameter& number) {
  if (number.kind == ModelParameterKind::kRef) {
    return model.jnt_type[number.element] == mjJNT_HINGE ? 1.0 : model.stat.extent;
  }
  const mjtNum* inertia = RowOf(model.body_inertia, 3, number.element);
  const double trace = inertia[0] + inertia[1] + inertia[2];
  return std::sqrt(trace / (2.0 * model.body_mass[number.element]));
}

const char* UnitName(const mjModel& model, const ModelParameter& number) {
  return number.kind == ModelParameterKind::kRef &&
                 model.jnt_type[number.element] == mjJNT_HINGE
             ? "rad"
             : "m";
}

double ValueOf(const mjModel& model, const ModelParameter& number) {
  if (IsAdditive(number.kind)) return PlaceOf(model, number);
  double largest = 0.0;
  if (!HasNumber(model, number)) return largest;
  // A feedback is what the bias takes away.
  if (number.kind == ModelParameterKind::kKp) {
    return -BiasOf(model, number.element)[kOfLength];
  }
  if (number.kind == ModelParameterKind::kKv) {
    return -BiasOf(model, number.element)[kOfVelocity];
  }
  for (const auto values : PlacesOf(model, number)) {
    for (const double value : values) {
      if (std::abs(value) > std::abs(largest)) largest = value;
    }
    if (largest != 0.0) break;
  }
  return largest;
}

double FactorFor(const mjModel& model, const ModelParameter& number, double value) {
  const auto fail = [&](const std::string& problem, const std::string& expected) {
    throw InputError("plant number " + ModelParameterName(model, number), problem,
                     expected);
  };
  if (!std::isfinite(value)) fail("is " + std::to_string(value), "a finite number");
  const double is = ValueOf(model, number);
  if (IsAdditive(number.kind)) {
    return std::exp((value - is) / UnitOf(model, number));
  }
  if (is == 0.0) fail("is 0 in the plant", "another plant that has it");
  if (value / is < 0.0) {
    fail("is " + std::to_string(is) + " in the plant", "a value of the same sign");
  }
  return value / is;
}

}  // namespace mjdiag
