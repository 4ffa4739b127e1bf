#include "mjdiag/discovery/hypotheses/candidate.h"

#include <algorithm>

#include "mjdiag/plugin/effects/fault_effect.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

void AddSitesOf(const EffectPtr& effect, const SiteMap& map,
                std::vector<Candidate>& candidates) {
  for (const Site& site : effect->CandidateSites(map)) {
    Candidate candidate{effect, site.name, site.joint, site.channel, {}};
    std::size_t i = 0;
    for (const EffectParameter& p : effect->parameters()) {
      const double least = effect->Least(map.plant(), site.joint, i++);
      const double nothing = p.role == Role::kFactor ? 1.0 : 0.0;
      const double most = std::min(p.maximum, p.plausible);
      candidate.parameters.push_back({p.name, p.role, least, most, nothing});
    }
    candidates.push_back(std::move(candidate));
  }
}

bool StandsFor(const Candidate& fault, const Candidate& effect) {
  return fault.effect->Twin() == effect.effect.get() && fault.site == effect.site;
}

}  // namespace

Eigen::Index PlaceOf(const Candidate& candidate, Role role) {
  return std::ranges::find(candidate.parameters, role, &FitParameter::role) -
         candidate.parameters.begin();
}

Eigen::Index PeriodPlace(const Candidate& candidate) {
  return std::ranges::find_if(candidate.parameters, IsPeriod, &FitParameter::role) -
         candidate.parameters.begin();
}

std::string CandidateName(const Candidate& candidate) {
  const std::string& name = candidate.effect->name();
  return candidate.effect->IsFault() ? name : name + "@" + candidate.site;
}

std::vector<Candidate> AllSites(const Machine& machine, bool with_seen) {
  const SiteMap map(machine.plant(), machine.mechanics(), machine.channels(),
                    with_seen);
  std::vector<Candidate> candidates;
  for (const PlacedEffect& fault : FaultEffects(machine.plant())) {
    AddSitesOf(fault.effect, map, candidates);
  }
  for (const Effect* effect : Effects()) {
    AddSitesOf(Lasting(*effect), map, candidates);
  }
  return candidates;
}

std::vector<Candidate> ListCandidates(const Machine& machine, bool with_seen) {
  std::vector<Candidate> candidates = AllSites(machine, with_seen);
  const std::vector<Candidate> all = candidates;
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return std::ranges::any_of(
        all, [&](const Candidate& fault) { return StandsFor(fault, candidate); });
  });
  return candidates;
}

}  // namespace mjdiag
