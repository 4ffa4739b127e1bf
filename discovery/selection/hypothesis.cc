#include "mjdiag/discovery/selection/hypothesis.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace mjdiag {

void Rank(std::vector<Hypothesis>& hypotheses) {
  std::ranges::stable_sort(hypotheses, std::less<>(), &Hypothesis::criterion);
  std::vector<Hypothesis> kept;
  double sum = 0.0;
  for (Hypothesis& c : hypotheses) {
    const bool seen = std::ranges::any_of(kept, [&](const Hypothesis& k) {
      return k.cause.candidate == c.cause.candidate;
    });
    if (seen) continue;
    c.probability = std::exp(-0.5 * (c.criterion - hypotheses.front().criterion));
    sum += c.probability;
    kept.push_back(c);
  }
  for (Hypothesis& c : kept) c.probability /= sum;
  hypotheses = std::move(kept);
}

}  // namespace mjdiag
