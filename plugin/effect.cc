#include "mjdiag/plugin/effect.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "mjdiag/plugin/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();
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

// The solver's default friction constraint is far too soft for a precision stage: it
// creeps. A time constant of two steps and an impedance near one make it behave as
// exact dry friction.
void ApplyCoulombFriction(mjModel& model, int joint, double force) {
  const int dof = model.jnt_dofadr[joint];
  model.dof_frictionloss[dof] += force;
  mjtNum* solref = model.dof_solref + mjNREF * dof;
  solref[0] = 2.0 * model.opt.timestep;
  solref[1] = 1.0;
  mjtNum* solimp = model.dof_solimp + mjNIMP * dof;
  solimp[0] = 0.99;
  solimp[1] = 0.999;
  solimp[2] = 1e-4;
}

}  // namespace

const std::vector<EffectType>& EffectCatalogue() {
  static const std::vector<EffectType> catalogue = {
      {"coulomb_friction",
       mjOBJ_JOINT,
       true,
       {{"force", "N", 0.0, kNoBound}},
       "dry friction: -force * sign(velocity), sticking at rest"},
      {"force_offset",
       mjOBJ_JOINT,
       false,
       {{"force", "N", -kNoBound, kNoBound}},
       "a constant force on the joint"},
  };
  return catalogue;
}

const EffectType& FindEffect(std::string_view name) {
  std::string known;
  for (const EffectType& type : EffectCatalogue()) {
    if (type.name == name) return type;
    known += (known.empty() ? "" : ", ") + type.name;
  }
  throw InputError("effect", "unknown effect '" + std::string(name) + "'",
                   "one of " + known);
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
    EffectSpec spec{std::string(name.substr(kPrefix.size(), dot - kPrefix.size())),
                    std::string(name.substr(dot + 1)),
                    {}};
    const std::vector<EffectParameter>& parameters = FindEffect(spec.effect).parameters;
    if (model.numeric_size[i] != static_cast<int>(parameters.size())) {
      throw InputError("custom numeric '" + std::string(name) + "'",
                       std::to_string(model.numeric_size[i]) + " values",
                       std::to_string(parameters.size()) + ": " + Names(parameters));
    }
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      spec.parameters[parameters[p].name] =
          model.numeric_data[model.numeric_adr[i] + static_cast<int>(p)];
    }
    effects.push_back(std::move(spec));
  }
  return effects;
}

int CheckEffect(const mjModel& model, const EffectSpec& effect) {
  const EffectType& type = FindEffect(effect.effect);
  const std::string where = "effect " + effect.effect + "@" + effect.site;
  for (const auto& [name, value] : effect.parameters) {
    const auto parameter =
        std::find_if(type.parameters.begin(), type.parameters.end(),
                     [&n = name](const EffectParameter& p) { return p.name == n; });
    if (parameter == type.parameters.end()) {
      throw InputError(where, "unknown parameter '" + name + "'",
                       Names(type.parameters));
    }
    if (!std::isfinite(value) || value < parameter->minimum ||
        value > parameter->maximum) {
      throw InputError(where, name + " = " + std::to_string(value),
                       "a value from " + std::to_string(parameter->minimum) + " to " +
                           std::to_string(parameter->maximum) + " " + parameter->unit);
    }
  }
  for (const EffectParameter& parameter : type.parameters) {
    if (!effect.parameters.contains(parameter.name)) {
      throw InputError(where, "'" + parameter.name + "' is missing",
                       Names(type.parameters));
    }
  }
  return FindElement(model, type.site, effect.site);
}

void ApplyNativeEffect(mjModel& model, const EffectSpec& effect) {
  const int site = CheckEffect(model, effect);
  if (effect.effect == "coulomb_friction") {
    ApplyCoulombFriction(model, site, effect.parameters.at("force"));
  }
}

}  // namespace mjdiag
