#include "mjdiag/plugin/effects/effect.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kPrefix = "effect.";

[[noreturn]] void FailToParse(std::string_view text, const std::string& what) {
  throw InputError("effect '" + std::string(text) + "'", what,
                   "<effect>@<site>:<name>=<value>,...");
}

double ParseValue(std::string_view text, std::string_view value) {
  double number = 0.0;
  const auto [end, error] =
      std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size()) {
    FailToParse(text, "'" + std::string(value) + "' is not a number");
  }
  return number;
}

std::string Names(const std::vector<EffectParameter>& parameters) {
  std::string names;
  for (const EffectParameter& parameter : parameters) {
    names += (names.empty() ? "" : ", ") + parameter.name;
  }
  return names;
}

const EffectParameter* FindParameter(const EffectType& type, std::string_view name) {
  for (const EffectParameter& parameter : type.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
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

void CheckSite(const mjModel& model, const std::string& where, EffectSite site,
               int id) {
  if (site != EffectSite::kJoint && site != EffectSite::kHeldJoint) return;
  const int type = model.jnt_type[id];
  if (type != mjJNT_SLIDE && type != mjJNT_HINGE) {
    throw InputError(where, "a joint of several degrees of freedom",
                     "a slide or hinge");
  }
  if (site == EffectSite::kHeldJoint && model.jnt_stiffness[id] == 0.0) {
    throw InputError(where, "the joint has no spring", "a joint with stiffness");
  }
}

/// Of a hinge, for a unit of a slide.
std::string HingeUnit(const std::string& unit) {
  static const std::map<std::string, std::string> kUnits{
      {"N", "N m"},           {"m", "rad"},
      {"m/s", "rad/s"},       {"kg", "kg m^2"},
      {"N/m", "N m/rad"},     {"N/m^3", "N m/rad^3"},
      {"N s/m", "N m s/rad"}, {"N s^2/m^2", "N m s^2/rad^2"}};
  const auto found = kUnits.find(unit);
  return found == kUnits.end() ? unit : found->second;
}

}  // namespace

double EffectSpec::Value(std::string_view parameter) const {
  const auto given = parameters.find(std::string(parameter));
  if (given != parameters.end()) return given->second;
  return FindParameter(FindEffect(effect), parameter)->fallback.value();
}

std::string SiteUnit(const mjModel& model, const EffectSpec& effect,
                     std::string_view parameter) {
  const EffectType& type = FindEffect(effect.effect);
  const std::string& unit = FindParameter(type, parameter)->unit;
  const int id = FindElement(model, type.element(), effect.site);
  const bool hinge = type.element() == mjOBJ_JOINT && model.jnt_type[id] == mjJNT_HINGE;
  return hinge ? HingeUnit(unit) : unit;
}

EffectSpec ParseEffect(std::string_view text) {
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos) FailToParse(text, "no site");
  const std::size_t colon = text.find(':', at);
  EffectSpec spec;
  spec.effect = text.substr(0, at);
  spec.site = text.substr(at + 1, colon == text.npos ? text.npos : colon - at - 1);
  std::string_view rest = colon == text.npos ? "" : text.substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(','));
    const std::size_t equals = item.find('=');
    if (equals == item.npos)
      FailToParse(text, "'" + std::string(item) + "' has no value");
    const std::string name(item.substr(0, equals));
    if (!spec.parameters.emplace(name, ParseValue(text, item.substr(equals + 1)))
             .second) {
      FailToParse(text, "'" + name + "' is given twice");
    }
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
  }
  return spec;
}

std::string FormatEffect(const EffectSpec& effect) {
  std::string text = effect.effect + "@" + effect.site;
  char separator = ':';
  for (const EffectParameter& parameter : FindEffect(effect.effect).parameters) {
    std::array<char, 32> digits{};
    std::to_chars(digits.data(), digits.data() + digits.size(),
                  effect.Value(parameter.name));
    text += separator + parameter.name + "=" + digits.data();
    separator = ',';
  }
  return text;
}

std::vector<EffectSpec> EffectsOf(const mjModel& model) {
  std::vector<EffectSpec> effects;
  for (int i = 0; i < model.nnumeric; ++i) {
    const std::string_view name(model.names + model.name_numericadr[i]);
    if (!name.starts_with(kPrefix)) continue;
    const std::size_t dot = name.find('.', kPrefix.size());
    if (dot == name.npos) {
      throw InputError("custom numeric '" + std::string(name) + "'", "names no site",
                       "effect.<name>.<site>");
    }
    const std::string effect(name.substr(kPrefix.size(), dot - kPrefix.size()));
    const std::vector<EffectParameter>& parameters = FindEffect(effect).parameters;
    const int count = static_cast<int>(parameters.size());
    const int size = model.numeric_size[i];
    if (size % count != 0) {
      throw InputError(
          "custom numeric '" + std::string(name) + "'",
          std::to_string(size) + " values",
          std::to_string(count) + " or several times that: " + Names(parameters));
    }
    const mjtNum* value = model.numeric_data + model.numeric_adr[i];
    for (int first = 0; first < size; first += count) {
      EffectSpec spec{effect, std::string(name.substr(dot + 1)), {}};
      for (const EffectParameter& parameter : parameters) {
        spec.parameters[parameter.name] = *value++;
      }
      effects.push_back(std::move(spec));
    }
  }
  return effects;
}

int CheckEffect(const mjModel& model, const EffectSpec& effect) {
  const EffectType& type = FindEffect(effect.effect);
  const std::string where = "effect " + effect.effect + "@" + effect.site;
  for (const auto& [name, value] : effect.parameters) {
    const EffectParameter* parameter = FindParameter(type, name);
    if (parameter == nullptr) {
      throw InputError(where, "unknown parameter '" + name + "'",
                       Names(type.parameters));
    }
    CheckValue(where, *parameter, value);
  }
  for (const EffectParameter& parameter : type.parameters) {
    if (!parameter.fallback && !effect.parameters.contains(parameter.name)) {
      throw InputError(where, "'" + parameter.name + "' is missing",
                       Names(type.parameters));
    }
  }
  const int site = FindElement(model, type.element(), effect.site);
  CheckSite(model, where, type.site, site);
  return site;
}

}  // namespace mjdiag
