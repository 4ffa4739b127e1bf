#include "mjdiag/discovery/hypotheses/cause.h"

#include <array>
#include <cstdio>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/fault_effect.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

std::string Number(double value) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.4g", value);
  return digits.data();
}

bool IsTwin(const Cause& a, const Cause& b) {
  return a.effect->Twin() == b.effect.get() && a.site == b.site;
}

}  // namespace

Changes ChangesOf(const std::vector<Cause>& causes) {
  Changes changes;
  for (const Cause& cause : causes) {
    if (cause.effect->IsFault()) {
      changes.faults.push_back({cause.name(), cause.values[0]});
    } else {
      changes.effects.push_back(cause);
    }
  }
  return changes;
}

std::string CauseWithValues(const Cause& cause) {
  if (cause.effect->IsFault()) return cause.name() + " = " + Number(cause.values[0]);
  std::string text = cause.name() + "@" + cause.site;
  if (cause.effect.get() == &ForceCurve()) return text;  // knots say nothing to people
  const char* separator = ": ";
  Eigen::Index i = 0;
  for (const EffectParameter& parameter : cause.effect->parameters()) {
    text += separator + parameter.name + " = " + Number(cause.values[i++]);
    separator = ", ";
  }
  return text;
}

bool Indistinguishable(const Cause& a, const Cause& b) {
  return SameKind(a, b) || IsTwin(a, b) || IsTwin(b, a);
}

std::vector<Cause> EquivalentCauses(const mjModel& model, const Cause& cause) {
  std::vector<Cause> twins;
  for (Cause& fault : FaultEffects(model)) {
    const Effect* twin = fault.effect->Twin();
    if (twin == nullptr) continue;
    if (SameKind(cause, fault)) {
      twins.push_back(
          {Lasting(*twin), fault.site, fault.effect->ToTwin(model, cause.values)});
    } else if (cause.effect.get() == twin && cause.site == fault.site) {
      if (auto value = fault.effect->FromTwin(model, cause.values)) {
        twins.push_back({fault.effect, fault.site, *value});
      }
    }
  }
  return twins;
}

}  // namespace mjdiag
