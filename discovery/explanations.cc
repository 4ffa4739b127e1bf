#include "mjdiag/discovery/explanations.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {
namespace {

constexpr double kLeastShare = 0.01;
constexpr std::size_t kMostSets = 8;

double TimesAsLikely(const Alternative& alternative, const FoundCause& named) {
  if (alternative.indistinguishable) return 1.0;
  const double ratio = alternative.probability / named.probability;
  return std::isfinite(ratio) ? ratio : 0.0;
}

}  // namespace

std::vector<CauseSet> ExplanationsOf(const std::vector<FoundCause>& named) {
  if (named.empty()) return {};
  std::vector<CauseSet> sets(1);
  for (const FoundCause& found : named) sets.front().causes.push_back(found.cause);
  const std::vector<Cause> as_named = sets.front().causes;
  sets.front().probability = 1.0;
  double sum = 1.0;
  for (std::size_t i = 0; i < named.size(); ++i) {
    for (const Alternative& other : named[i].alternatives) {
      const bool is_named = std::ranges::any_of(
          as_named, [&](const Cause& cause) { return SameKind(cause, other.cause); });
      if (is_named) continue;
      CauseSet& set = sets.emplace_back(as_named, TimesAsLikely(other, named[i]));
      set.causes[i] = other.cause;
      sum += set.probability;
    }
  }
  for (CauseSet& set : sets) set.probability /= sum;
  std::ranges::stable_sort(sets, std::ranges::greater{}, &CauseSet::probability);
  const auto unlikely = std::ranges::find_if(
      sets, [](const CauseSet& set) { return set.probability < kLeastShare; });
  sets.erase(unlikely, sets.end());
  if (sets.size() > kMostSets) sets.resize(kMostSets);
  return sets;
}

}  // namespace mjdiag
