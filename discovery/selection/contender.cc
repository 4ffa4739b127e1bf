#include "mjdiag/discovery/selection/contender.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace mjdiag {

void Rank(std::vector<Contender>& contenders) {
  std::ranges::stable_sort(contenders, std::less<>(), &Contender::criterion);
  std::vector<Contender> kept;
  double sum = 0.0;
  for (Contender& c : contenders) {
    const bool seen = std::ranges::any_of(kept, [&](const Contender& k) {
      return k.cause.candidate == c.cause.candidate;
    });
    if (seen) continue;
    c.probability = std::exp(-0.5 * (c.criterion - contenders.front().criterion));
    sum += c.probability;
    kept.push_back(c);
  }
  for (Contender& c : kept) c.probability /= sum;
  contenders = std::move(kept);
}

}  // namespace mjdiag
