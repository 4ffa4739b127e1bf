#include "mjdiag/discovery/fitting/nested_law.h"

#include <algorithm>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {
namespace {

/// The first of the causes that is a candidate.
std::optional<FittedCause> AsCandidate(const std::vector<Candidate>& candidates,
                                       const std::vector<Cause>& causes) {
  for (const Cause& cause : causes) {
    const auto found =
        std::ranges::find_if(candidates, [&](const Candidate& candidate) {
          return SameKind({candidate.effect, candidate.site, {}}, cause);
        });
    if (found == candidates.end()) continue;
    return Bounded(candidates, {static_cast<std::size_t>(found - candidates.begin()),
                                cause.values});
  }
  return std::nullopt;
}

}  // namespace

std::optional<FittedCause> SimplerLaw(const mjModel& plant,
                                      const std::vector<Candidate>& candidates,
                                      const FittedCause& cause) {
  const Cause present = CauseOf(candidates, cause);
  const auto simpler = present.effect->Simpler(present);
  if (!simpler) return std::nullopt;
  std::vector<Cause> same = Twins(plant, *simpler);
  same.insert(same.begin(), *simpler);
  return AsCandidate(candidates, same);
}

}  // namespace mjdiag
