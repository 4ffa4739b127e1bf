#include "mjdiag/studies/coverage.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {
namespace {

/// Whether a wave's amplitude is negative: a sine of a negative one is a sine of another
/// phase.
bool IsTurned(const Cause& cause) {
  const auto phase = cause.effect->Find(Role::kPhase);
  const auto amplitude = cause.effect->Find(Role::kAmplitude);
  return phase && amplitude && cause.values[*amplitude] < 0.0;
}

/// Its values with an amplitude >= 0.
Eigen::VectorXd Normalised(const Cause& cause) {
  Eigen::VectorXd values = cause.values;
  if (!IsTurned(cause)) return values;
  values[cause.effect->Find(Role::kAmplitude).value()] *= -1.0;
  values[cause.effect->Find(Role::kPhase).value()] += std::numbers::pi;
  return values;
}

/// Whether a true value lies in the interval, an end of which may be missing; one
/// without both says nothing and covers nothing. Phases up to whole turns.
bool Covers(const CauseParameter& parameter, Role role, double truth, double shift) {
  double off = truth - (parameter.value + shift);
  if (role == Role::kPhase) off = std::remainder(off, 2.0 * std::numbers::pi);
  return (std::isfinite(parameter.low) || std::isfinite(parameter.high)) &&
         off >= parameter.low - parameter.value &&
         off <= parameter.high - parameter.value;
}

/// The value of that kind which is the same change of the model; none if none is.
std::optional<double> TwinValue(const mjModel& plant, Cause cause, double value,
                                const Cause& kind) {
  cause.values[0] = value;
  for (const Cause& twin : EquivalentCauses(plant, cause)) {
    if (SameKind(twin, kind)) return twin.values[0];
  }
  return std::nullopt;
}

void Count(const mjModel& plant, const FoundCause& found, const Cause& truth,
           Coverage& coverage) {
  if (!SameKind(found.cause, truth)) {
    // A fault parameter for an effect or the other way round: the interval of the twin
    // is that of the one found.
    const CauseParameter& parameter = found.parameters.front();
    const auto low = TwinValue(plant, found.cause, parameter.low, truth);
    const auto high = TwinValue(plant, found.cause, parameter.high, truth);
    if (!low || !high) return;
    const double value = truth.values[0];
    ++coverage.parameters;
    coverage.inside += std::min(*low, *high) <= value && value <= std::max(*low, *high);
    return;
  }
  const Eigen::VectorXd values = Normalised(truth);
  const bool turned = IsTurned(found.cause);
  const Eigen::VectorXd shifts = Normalised(found.cause) - found.cause.values;
  for (std::size_t i = 0; i < found.parameters.size(); ++i) {
    CauseParameter parameter = found.parameters[i];
    const auto place = static_cast<Eigen::Index>(i);
    const Role role = found.cause.effect->parameters()[i].role;
    ++coverage.parameters;
    if (turned && role == Role::kAmplitude) {
      parameter.value = -parameter.value;
      std::swap(parameter.low, parameter.high);
      parameter.low = -parameter.low;
      parameter.high = -parameter.high;
    }
    const double shift = role == Role::kPhase ? shifts[place] : 0.0;
    coverage.inside += Covers(parameter, role, values[place], shift);
  }
}

}  // namespace

Coverage CoverageOf(const mjModel& plant, const std::vector<Cause>& truth,
                    const std::vector<FoundCause>& found) {
  Coverage coverage;
  for (const Cause& cause : truth) {
    const auto named = std::ranges::find_if(found, [&](const FoundCause& one) {
      return Indistinguishable(one.cause, cause);
    });
    if (named != found.end()) Count(plant, *named, cause, coverage);
  }
  return coverage;
}

}  // namespace mjdiag
