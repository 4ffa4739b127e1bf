#include "mjdiag/discovery/selection/comparator.h"

#include <algorithm>

#include "mjdiag/discovery/selection/model_choice.h"

namespace mjdiag {
namespace {

/// Whether both are the same hypotheses, in any order, with whatever values.
bool SameHypotheses(const Evidence& a, const Evidence& b) {
  return std::ranges::is_permutation(a.fit().causes, b.fit().causes, std::equal_to<>(),
                                     &FittedCause::candidate, &FittedCause::candidate);
}

}  // namespace

Judgement Judge(const Evidence& present, const Evidence& proposed) {
  const Eigen::VectorXd& independent = proposed.independent();
  const double gain = present.Criterion(independent) - proposed.Criterion(independent);
  const double margin = SameHypotheses(present, proposed) ? 1.0 : 0.0;
  if (!(gain > margin)) return Judgement::kCriterion;
  const bool larger = proposed.hypotheses() > present.hypotheses();
  if (larger && !(proposed.addition() && proposed.addition()->IsMoreThanChance())) {
    return Judgement::kChance;
  }
  constexpr double kWorse = 0.02;
  if (present.fit().train > kFarAboveNoise && present.HasFreeRun()) {
    return proposed.FreeRun() <= present.FreeRun() + kWorse ? Judgement::kAccepted
                                                            : Judgement::kUnseen;
  }
  // Where what is known beforehand speaks for a cause, data that it explains no better
  // than numbers that are far off do need not speak for it, too.
  const double known = std::max(0.0, present.fit().prior - proposed.fit().prior);
  const double allowed = larger ? known : gain;
  return proposed.Unseen(independent) <= present.Unseen(independent) + allowed
             ? Judgement::kAccepted
             : Judgement::kUnseen;
}

std::optional<std::size_t> BestOf(
    const Evidence& present, const std::vector<std::optional<Evidence>>& proposed) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < proposed.size(); ++i) {
    if (!proposed[i]) continue;
    const Evidence& before = best ? *proposed[*best] : present;
    if (Judge(before, *proposed[i]) == Judgement::kAccepted) best = i;
  }
  return best;
}

}  // namespace mjdiag
