#include "mjdiag/discovery/fit/moved_model.h"

#include <algorithm>
#include <map>

namespace mjdiag {

Model After(const ModelMove& move, const Model& model) {
  Model after;
  for (std::size_t m = 0; m < model.size(); ++m) {
    if (std::ranges::find(move.removed, m) == move.removed.end()) {
      after.push_back(model[m]);
    }
  }
  for (const Added& added : move.added) {
    after.push_back({added.variation.block, *added.variation.values(added.amplitudes)});
  }
  return after;
}

Model Abrupt(const std::vector<Block>& blocks, Model model) {
  for (Member& member : model) {
    const Block& block = blocks[member.block];
    if (!block.IsSmoothFriction()) continue;
    const auto simplest = std::ranges::find_if(blocks, [&](const Block& other) {
      return other.group == block.group && other.IsDryFriction() && other.IsSimplest();
    });
    if (simplest == blocks.end()) continue;
    member = {static_cast<std::size_t>(simplest - blocks.begin()),
              member.values.head(1)};
  }
  return model;
}

std::vector<const ModelMove*> ToBeFitted(
    const Moves& moves, std::size_t most,
    const std::function<bool(const ModelMove&)>& may_be) {
  std::vector<const ModelMove*> chosen;
  bool has_single = most == 1;
  // What imitates what is missing may come first with everything else beside it.
  constexpr int kOfBlock = 2;
  std::map<std::size_t, int> with_block;
  for (const ModelMove& move : moves.best) {
    if (move.score > moves.score - kLeastGain || !may_be(move)) continue;
    if (std::ranges::any_of(move.added, [&](const Added& added) {
          return with_block[added.variation.block] >= kOfBlock;
        })) {
      continue;
    }
    const bool is_single = move.removed.empty() && move.added.size() == 1;
    if (chosen.size() >= most && (has_single || !is_single)) continue;
    chosen.push_back(&move);
    for (const Added& added : move.added) ++with_block[added.variation.block];
    has_single = has_single || is_single;
  }
  return chosen;
}

}  // namespace mjdiag
