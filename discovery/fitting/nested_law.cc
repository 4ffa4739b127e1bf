#include "mjdiag/discovery/fitting/nested_law.h"

#include <algorithm>
#include <string>

#include "mjdiag/discovery/screening/screening.h"

namespace mjdiag {
namespace {

struct NestedLaw {
  std::string law;
  std::string simpler;
  std::string parameter;           ///< of the simpler law
  std::vector<std::string> means;  ///< parameters whose mean it is
};

const std::vector<NestedLaw>& NestedLaws() {
  static const std::vector<NestedLaw> laws = {
      {"stribeck_friction", "coulomb_friction", "force", {"coulomb"}},
      {"presliding_hysteresis", "coulomb_friction", "force", {"force"}},
      {"asymmetric_viscous_friction",
       "viscous_friction",
       "coefficient",
       {"positive", "negative"}},
      {"hysteretic_stiffness", "linear_stiffness", "stiffness", {"stiffness"}},
      {"flexible_mode", "added_mass", "mass", {"mass"}},
  };
  return laws;
}

/// The first of the causes that is a candidate.
std::optional<FittedCause> AsCandidate(const std::vector<Candidate>& candidates,
                                       const std::vector<Cause>& causes) {
  for (const Cause& cause : causes) {
    const auto found = std::ranges::find_if(
        candidates,
        [&](const Candidate& candidate) { return SameKind(candidate.cause, cause); });
    if (found == candidates.end()) continue;
    Start start;
    start.candidate = static_cast<std::size_t>(found - candidates.begin());
    start.parameters = cause.spec.parameters;
    return FittedFrom(candidates, start);
  }
  return std::nullopt;
}

}  // namespace

std::optional<FittedCause> SimplerLaw(const mjModel& plant,
                                      const std::vector<Candidate>& candidates,
                                      const FittedCause& cause) {
  const Cause present = CauseOf(candidates, cause);
  const auto nested =
      std::ranges::find(NestedLaws(), present.spec.effect, &NestedLaw::law);
  if (present.fault || nested == NestedLaws().end()) return std::nullopt;
  Cause simpler;
  simpler.spec.effect = nested->simpler;
  simpler.spec.site = present.spec.site;
  double sum = 0.0;
  for (const std::string& name : nested->means) sum += present.spec.Value(name);
  simpler.spec.parameters[nested->parameter] =
      sum / static_cast<double>(nested->means.size());
  std::vector<Cause> same = Twins(plant, simpler);
  same.insert(same.begin(), simpler);
  return AsCandidate(candidates, same);
}

}  // namespace mjdiag
