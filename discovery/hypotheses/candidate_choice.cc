#include "mjdiag/discovery/hypotheses/candidate_choice.h"

#include <algorithm>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

bool IsNamed(const Effect& effect, const std::string& site, const std::string& text) {
  return text == effect.name() || text == FamilyName(effect.family()) ||
         (!effect.IsFault() && text == effect.name() + "@" + site);
}

bool IsMeantBy(const Candidate& candidate, const std::string& text) {
  const Effect* twin = candidate.effect->Twin();
  return IsNamed(*candidate.effect, candidate.site, text) ||
         (twin != nullptr && IsNamed(*twin, candidate.site, text));
}

bool IsMeantByAny(const Candidate& candidate, const std::vector<std::string>& texts) {
  return std::ranges::any_of(
      texts, [&](const std::string& text) { return IsMeantBy(candidate, text); });
}

/// What an effect that is known may be called at the sites of a machine.
std::vector<std::string> PlacesOf(const std::vector<Candidate>& all,
                                  const std::string& effect) {
  std::vector<std::string> places;
  for (const Candidate& candidate : all) {
    if (candidate.effect->IsFault() || candidate.effect->name() != effect) continue;
    places.push_back(CandidateName(candidate));
  }
  return places;
}

/// All that a name without a site may be.
std::vector<std::string> PlainNames(const std::vector<Candidate>& all) {
  std::vector<std::string> names;
  for (const Family family : kFamilies) names.push_back(FamilyName(family));
  for (const Candidate& candidate : all) {
    if (candidate.effect->IsFault()) names.push_back(CandidateName(candidate));
  }
  for (const Effect* effect : Effects()) names.push_back(effect->name());
  return names;
}

void RequireMeaning(const std::vector<Candidate>& all, const std::string& option,
                    const std::string& text) {
  if (std::ranges::any_of(all,
                          [&](const Candidate& c) { return IsMeantBy(c, text); })) {
    return;
  }
  const std::vector<std::string> plain = PlainNames(all);
  // An effect that has no place on this machine may be left out all the same.
  if (std::ranges::find(plain, text) != plain.end()) return;
  const std::vector<std::string> places = PlacesOf(all, text.substr(0, text.find('@')));
  throw InputError(option, "'" + text + "' is no cause that is looked for here",
                   places.empty()
                       ? "one of " + Listed(plain) + ", or an effect at a site as in " +
                             (all.empty() ? "" : CandidateName(all.back()))
                       : "one of " + Listed(places));
}

}  // namespace

bool IsChosen(const Candidate& candidate, const CandidateChoice& choice) {
  return !IsMeantByAny(candidate, choice.without) &&
         (choice.only.empty() || IsMeantByAny(candidate, choice.only));
}

std::vector<Candidate> ChooseCandidates(const Machine& machine,
                                        const CandidateChoice& choice, bool with_seen) {
  const std::vector<Candidate> all = AllSites(machine, with_seen);
  for (const std::string& text : choice.only) RequireMeaning(all, "--only", text);
  for (const std::string& text : choice.without) RequireMeaning(all, "--without", text);
  std::vector<Candidate> candidates = ListCandidates(machine, with_seen);
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return !IsChosen(candidate, choice);
  });
  if (candidates.empty()) {
    throw InputError("--only, --without", "together they leave no cause to look for",
                     "at least one");
  }
  return candidates;
}

}  // namespace mjdiag
