#include "mjdiag/discovery/answer/posterior.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace mjdiag {

namespace {

/// -2 ln of how much less probable it is to a weight.
double WeightOf(double worse) { return std::exp(-0.5 * std::max(0.0, worse)); }

/// Blocks that could be in the place of a member, each with the best of its shapes, weighed:
/// those that were fitted there, and of those that were not what first order says.
std::vector<Rival> RivalsOf(const Explained& explained, const UnseenJudgement& judged,
                            std::size_t member) {
  std::vector<Rival> rivals;
  for (const MemberExchange& one : judged.exchanges[member]) {
    rivals.push_back({one.block, one.values, WeightOf(one.loss.Total())});
  }
  const std::size_t fitted = rivals.size();
  const std::size_t place = judged.places[member];
  // First order is about what the search had there.
  const std::size_t block = judged.answer.fit.model[member].block;
  if (block != explained.fit.model[place].block) return rivals;
  for (const ModelMove& move : explained.rivals) {
    if (move.added.size() != 1 || move.removed != std::vector{place}) continue;
    const Variation& one = move.added.front().variation;
    if (one.block == block) continue;
    const RegressorValues values = one.values(move.added.front().amplitudes);
    if (!values) continue;
    const double weight = WeightOf(move.score);
    const auto known = std::ranges::find(rivals, one.block, &Rival::block);
    if (known == rivals.end()) {
      rivals.push_back({one.block, *values, weight});
    } else if (known - rivals.begin() >= static_cast<std::ptrdiff_t>(fitted) &&
               weight > known->probability) {
      *known = {one.block, *values, weight};
    }
  }
  return rivals;
}

}  // namespace

std::vector<MemberPosterior> PosteriorOf(const Explained& explained,
                                         const UnseenJudgement& judged) {
  std::vector<MemberPosterior> all;
  for (std::size_t m = 0; m < judged.places.size(); ++m) {
    MemberPosterior one;
    one.rivals = RivalsOf(explained, judged, m);
    one.none = WeightOf(judged.losses[m].Total());
    double sum = 1.0 + one.none;
    for (const Rival& rival : one.rivals) sum += rival.probability;
    one.probability = 1.0 / sum;
    one.none /= sum;
    for (Rival& rival : one.rivals) rival.probability /= sum;
    std::ranges::sort(one.rivals, std::greater<>(), &Rival::probability);
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace mjdiag
