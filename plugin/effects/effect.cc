#include "mjdiag/plugin/effects/effect.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;

constexpr double kAny = std::numeric_limits<double>::infinity();
// Rounded up: 2 pi itself is within.
constexpr double kFullTurn = 6.283185307179587;

template <typename Matches>
std::optional<Index> PlaceOf(const std::vector<EffectParameter>& parameters,
                             const Matches& matches) {
  const auto found = std::ranges::find_if(parameters, matches);
  if (found == parameters.end()) return std::nullopt;
  return found - parameters.begin();
}

}  // namespace

std::string FamilyName(Family family) {
  switch (family) {
    case Family::kFriction:
      return "friction";
    case Family::kDrive:
      return "drive";
    case Family::kStructure:
      return "structure";
    case Family::kEncoder:
      return "encoder";
  }
  return "";
}

EffectParameter Effect::Free(std::string name, Role role, std::string unit) {
  return {std::move(name), role, std::move(unit), -kAny, kAny};
}

EffectParameter Effect::NotNegative(std::string name, Role role, std::string unit) {
  return {std::move(name), role, std::move(unit), 0.0, kAny};
}

EffectParameter Effect::Positive(std::string name, Role role, std::string unit) {
  return {std::move(name), role, std::move(unit), std::numeric_limits<double>::min(),
          kAny};
}

EffectParameter Effect::Phase() {
  return {"phase", Role::kPhase, "rad", -kFullTurn, kFullTurn, 0.0};
}

EffectValues ValuesOf(std::initializer_list<double> values) {
  EffectValues list(static_cast<Index>(values.size()));
  std::ranges::copy(values, list.begin());
  return list;
}

const std::string& PlacedEffect::name() const { return effect->name(); }

double PlacedEffect::Value(std::string_view parameter) const {
  return values[effect->Find(parameter).value()];
}

bool PlacedEffect::operator==(const PlacedEffect& other) const {
  return SameKind(*this, other) && values == other.values;
}

bool SameKind(const PlacedEffect& a, const PlacedEffect& b) {
  return a.effect->IsFault() == b.effect->IsFault() && a.name() == b.name() &&
         a.site == b.site;
}

mjtObj Effect::element() const {
  switch (type_.site) {
    case SiteKind::kActuator:
      return mjOBJ_ACTUATOR;
    case SiteKind::kSensor:
      return mjOBJ_SENSOR;
    default:
      return mjOBJ_JOINT;
  }
}

std::optional<Index> Effect::Find(std::string_view parameter) const {
  return PlaceOf(parameters(),
                 [&](const EffectParameter& p) { return p.name == parameter; });
}

std::optional<Index> Effect::Find(Role role) const {
  return PlaceOf(parameters(),
                 [&](const EffectParameter& p) { return p.role == role; });
}

std::unique_ptr<ActiveEffect> Effect::Activate(const mjModel&, const Channels&, int,
                                               const EffectValues&) const {
  return nullptr;
}

std::vector<Site> Effect::CandidateSites(const SiteMap& map) const {
  switch (type_.site) {
    case SiteKind::kActuator:
      return map.Actuators();
    case SiteKind::kSensor:
      return map.Sensors();
    case SiteKind::kHeldJoint:
      return map.Joints(map.Held());
    default:
      return map.Joints(map.driven());
  }
}

EffectValues Effect::Spread(const Scales& scales) const {
  EffectValues spread(static_cast<Index>(parameters().size()));
  Index i = 0;
  for (const EffectParameter& parameter : parameters()) {
    const bool size =
        parameter.role == Role::kAmplitude || parameter.role == Role::kFactor;
    spread[i++] = size ? MachineUnit(scales, parameter.unit) : kAny;
  }
  return spread;
}

double Effect::Least(const mjModel&, Index, std::size_t parameter) const {
  return parameters()[parameter].minimum;
}

std::optional<ParameterScan> Effect::MakeParameterScan(const SiteMotion&,
                                                       double) const {
  return std::nullopt;
}

std::optional<PlacedEffect> Effect::Simpler(const PlacedEffect&) const {
  return std::nullopt;
}

std::optional<double> Effect::Law(double, const EffectValues&) const {
  return std::nullopt;
}

std::optional<ModelParameter> NumberAt(const Effect& effect, const mjModel& plant,
                                       const std::string& site) {
  const int element = mj_name2id(&plant, effect.element(), site.c_str());
  if (element < 0) return std::nullopt;  // a sensor channel
  return effect.Number(plant, element);
}

std::string Where(const Effect& effect, const std::string& site) {
  return "effect " + effect.name() + "@" + site;
}

void FailTooMuch(const Effect& effect, const mjModel& model, int element,
                 const char* what) {
  throw InputError(Where(effect, ElementName(model, effect.element(), element)),
                   std::string("takes away more ") + what + " than there is",
                   "a smaller value");
}

}  // namespace mjdiag
