#include "mjdiag/plugin/effects/placed_effect.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

using Eigen::Index;

constexpr std::string_view kPrefix = "effect.";

[[noreturn]] void FailToParse(std::string_view text, const std::string& what) {
  throw InputError("effect '" + std::string(text) + "'", what,
                   "<effect>@<site>:<name>=<value>,...");
}

std::string Names(const std::vector<EffectParameter>& parameters) {
  std::string names;
  for (const EffectParameter& parameter : parameters) {
    names += (names.empty() ? "" : ", ") + parameter.name;
  }
  return names;
}

void CheckValue(const std::string& where, const EffectParameter& parameter,
                double value) {
  if (std::isfinite(value) && value >= parameter.minimum &&
      value <= parameter.maximum) {
    return;
  }
  // The smallest positive number stands for "> 0".
  const bool open = parameter.minimum == std::numeric_limits<double>::min();
  throw InputError(where, parameter.name + " = " + std::to_string(value),
                   open ? "a value > 0 " + parameter.unit
                        : "a value from " + std::to_string(parameter.minimum) + " to " +
                              std::to_string(parameter.maximum) + " " + parameter.unit);
}

void CheckSite(const mjModel& model, const std::string& where, SiteKind site, int id) {
  if (site == SiteKind::kActuator || site == SiteKind::kSensor) return;
  const int type = model.jnt_type[id];
  if (type != mjJNT_SLIDE && type != mjJNT_HINGE) {
    throw InputError(where, "a joint of several degrees of freedom",
                     "a slide or hinge");
  }
  if (site == SiteKind::kHinge && type != mjJNT_HINGE) {
    throw InputError(where, "the joint is a slide", "a hinge");
  }
  if (site == SiteKind::kHeldJoint && model.jnt_stiffness[id] == 0.0) {
    throw InputError(where, "the joint has no spring", "a joint with stiffness");
  }
}

/// Of a hinge, for a unit of a slide.
std::string HingeUnit(const std::string& unit) {
  static const std::map<std::string, std::string> kUnits{
      {"N", "N m"},
      {"m", "rad"},
      {"m/s", "rad/s"},
      {"kg", "kg m^2"},
      {"N/m", "N m/rad"},
      {"N/m^3", "N m/rad^3"},
      {"1/m", "1/rad"},
      {"m/N", "rad/(N m)"},
      {"1/N", "1/N/m"},
      {"N/m^2", "N m/rad^2"},
      {"N s/m^2", "N m s/rad^2"},
      {"N s/m^3", "N m s/rad^3"},
      {"N s/m", "N m s/rad"},
      {"N s^2/m^2", "N m s^2/rad^2"}};
  const auto found = kUnits.find(unit);
  return found == kUnits.end() ? unit : found->second;
}

/// Whether a sensor reads where a hinge is, or hinges along a tendon.
bool ReadsAngle(const mjModel& model, int sensor) {
  const int object = model.sensor_objid[sensor];
  switch (model.sensor_type[sensor]) {
    case mjSENS_JOINTPOS:
      return model.jnt_type[object] == mjJNT_HINGE;
    case mjSENS_TENDONPOS: {
      const int first = model.tendon_adr[object];
      for (int i = first; i < first + model.tendon_num[object]; ++i) {
        if (model.wrap_type[i] != mjWRAP_JOINT ||
            model.jnt_type[model.wrap_objid[i]] != mjJNT_HINGE) {
          return false;
        }
      }
      return true;
    }
    default:
      return false;
  }
}

}  // namespace

PlacedEffect Place(std::string_view name, std::string site,
                   const std::map<std::string, double>& values) {
  const Effect& effect = FindEffect(name);
  const std::vector<EffectParameter>& parameters = effect.parameters();
  const std::string where = Where(effect, site);
  PlacedEffect placed{Lasting(effect), std::move(site),
                      EffectValues(static_cast<Index>(parameters.size()))};
  for (const auto& [given, value] : values) {
    const auto place = effect.Find(given);
    if (!place) {
      throw InputError(where, "unknown parameter '" + given + "'", Names(parameters));
    }
    CheckValue(where, parameters[static_cast<std::size_t>(*place)], value);
    placed.values[*place] = value;
  }
  Index i = 0;
  for (const EffectParameter& parameter : parameters) {
    if (!values.contains(parameter.name)) {
      if (!parameter.fallback) {
        throw InputError(where, "'" + parameter.name + "' is missing",
                         Names(parameters));
      }
      placed.values[i] = *parameter.fallback;
    }
    ++i;
  }
  return placed;
}

PlacedEffect ParseEffect(std::string_view text) {
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos) FailToParse(text, "no site");
  const std::size_t colon = text.find(':', at);
  const std::string_view site =
      text.substr(at + 1, colon == text.npos ? text.npos : colon - at - 1);
  const auto values =
      ParseAssignments(colon == text.npos ? "" : text.substr(colon + 1),
                       [&](const std::string& what) { FailToParse(text, what); });
  return Place(text.substr(0, at), std::string(site), {values.begin(), values.end()});
}

std::string FormatEffect(const PlacedEffect& effect) {
  std::string text = effect.name() + "@" + effect.site;
  char separator = ':';
  Index i = 0;
  for (const EffectParameter& parameter : effect.effect->parameters()) {
    std::array<char, 32> digits{};
    std::to_chars(digits.data(), digits.data() + digits.size(), effect.values[i++]);
    text += separator + parameter.name + "=" + digits.data();
    separator = ',';
  }
  return text;
}

std::map<std::string, double> NamedValues(const PlacedEffect& effect) {
  std::map<std::string, double> values;
  Index i = 0;
  for (const EffectParameter& parameter : effect.effect->parameters()) {
    values[parameter.name] = effect.values[i++];
  }
  return values;
}

std::vector<PlacedEffect> EffectsOf(const mjModel& model) {
  std::vector<PlacedEffect> effects;
  for (int i = 0; i < model.nnumeric; ++i) {
    const std::string_view name(model.names + model.name_numericadr[i]);
    if (!name.starts_with(kPrefix)) continue;
    const std::size_t dot = name.find('.', kPrefix.size());
    if (dot == name.npos) {
      throw InputError("custom numeric '" + std::string(name) + "'", "names no site",
                       "effect.<name>.<site>");
    }
    const Effect& effect =
        FindEffect(name.substr(kPrefix.size(), dot - kPrefix.size()));
    const int count = static_cast<int>(effect.parameters().size());
    const int size = model.numeric_size[i];
    if (size % count != 0) {
      throw InputError("custom numeric '" + std::string(name) + "'",
                       std::to_string(size) + " values",
                       std::to_string(count) +
                           " or several times that: " + Names(effect.parameters()));
    }
    const mjtNum* first = model.numeric_data + model.numeric_adr[i];
    for (int k = 0; k < size; k += count) {
      effects.push_back({Lasting(effect), std::string(name.substr(dot + 1)),
                         Eigen::Map<const EffectValues>(first + k, count)});
    }
  }
  return effects;
}

int CheckEffect(const mjModel& model, const PlacedEffect& placed) {
  const Effect& effect = *placed.effect;
  const std::string where = Where(effect, placed.site);
  Index i = 0;
  for (const EffectParameter& parameter : effect.parameters()) {
    CheckValue(where, parameter, placed.values[i++]);
  }
  const int element = FindElement(model, effect.element(), placed.site);
  CheckSite(model, where, effect.site(), element);
  return element;
}

void ApplyEffect(mjModel& model, const PlacedEffect& placed) {
  placed.effect->Apply(model, CheckEffect(model, placed), placed.values);
}

std::string SiteUnit(const mjModel& model, const Effect& effect,
                     const std::string& site, const EffectParameter& parameter) {
  // A factor, and of elements that may be several.
  if (effect.IsFault()) return parameter.unit;
  if (effect.element() == mjOBJ_ACTUATOR && parameter.role == Role::kLimit) {
    // The command itself where a unit of it is a unit of force.
    const int motor = FindElement(model, mjOBJ_ACTUATOR, site);
    const bool same =
        MotorGain(model, motor) == 1.0 && model.actuator_biastype[motor] == mjBIAS_NONE;
    return same ? parameter.unit : "before the gear";
  }
  bool turns = false;
  if (effect.element() == mjOBJ_JOINT) {
    turns = model.jnt_type[FindElement(model, mjOBJ_JOINT, site)] == mjJNT_HINGE;
  } else if (effect.element() == mjOBJ_SENSOR) {
    turns = ReadsAngle(model, FindElement(model, mjOBJ_SENSOR, site));
  }
  return turns ? HingeUnit(parameter.unit) : parameter.unit;
}

}  // namespace mjdiag
