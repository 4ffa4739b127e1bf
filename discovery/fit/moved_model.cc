#include "mjdiag/discovery/fit/moved_model.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

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

namespace {

using IsSo = std::function<bool(const Block&)>;

/// The block of the same joint's friction that is so; none if it has none.
std::optional<std::size_t> InPlaceOf(const std::vector<Block>& blocks,
                                     const Block& block, const IsSo& is_so) {
  const auto found = std::ranges::find_if(blocks, [&](const Block& other) {
    return !block.group.empty() && other.group == block.group && is_so(other);
  });
  if (found == blocks.end()) return std::nullopt;
  return static_cast<std::size_t>(found - blocks.begin());
}

/// The members that are so in their joints' form that is as they shall be, where there is one.
/// @param values  of a member in the block of that form; none: it stays
Model InForm(const std::vector<Block>& blocks, Model model, const IsSo& are,
             const IsSo& shall_be,
             const std::function<std::optional<Eigen::VectorXd>(
                 const Member&, const Block& form)>& values) {
  for (Member& member : model) {
    if (!are(blocks[member.block])) continue;
    const auto form = InPlaceOf(blocks, blocks[member.block], shall_be);
    if (!form) continue;
    auto there = values(member, blocks[*form]);
    if (there) member = {*form, *std::move(there)};
  }
  return model;
}

bool IsAbrupt(const Block& block) {
  return block.IsDryFriction() && block.IsSimplest() && !block.GivesWay();
}

/// Whether it slides by one force, however it comes to it.
bool IsOfOneSize(const Block& block) {
  return block.IsSmoothFriction() || block.GivesWay() || block.Springs() ||
         IsAbrupt(block);
}

/// The form knows the force alone.
Eigen::VectorXd ForceOf(const Member& member, const Block&) {
  return member.values.head(1);
}

}  // namespace

Model Abrupt(const std::vector<Block>& blocks, Model model) {
  const auto are = [](const Block& one) { return IsOfOneSize(one) && !IsAbrupt(one); };
  return InForm(blocks, std::move(model), are, IsAbrupt, ForceOf);
}

Model Creeping(const std::vector<Block>& blocks, Model model) {
  const auto are = [](const Block& one) { return one.candidate && IsAbrupt(one); };
  const auto values = [](const Member& member,
                         const Block& form) -> std::optional<Eigen::VectorXd> {
    // A filter does not follow what turns round within its doubt of a velocity: it begins by
    // a wide step, which a fit makes as steep as it is.
    constexpr double kOfFastest = 0.1;
    const double fastest = 0.5 * form.candidate->parameters[1].upper;
    if (!(fastest > 0.0)) return std::nullopt;
    return Eigen::VectorXd{{member.values[0], kOfFastest * fastest}};
  };
  return InForm(blocks, std::move(model), are, &Block::IsSmoothFriction, values);
}

Model GivingWay(const std::vector<Block>& blocks, Model model) {
  const auto are = [](const Block& one) { return IsOfOneSize(one) && !one.GivesWay(); };
  return InForm(blocks, std::move(model), are, &Block::GivesWay, ForceOf);
}

Model Springing(const std::vector<Block>& blocks, Model model,
                const Eigen::VectorXd& lengths) {
  const auto values = [&](const Member& member,
                          const Block& form) -> std::optional<Eigen::VectorXd> {
    const double length = lengths[blocks[member.block].candidate->joint];
    if (!(length > 0.0)) return std::nullopt;
    const double force = member.values[0];
    const double stiffest = form.candidate->parameters.back().upper;
    return Eigen::VectorXd{{force, std::min(force / length, stiffest)}};
  };
  return InForm(blocks, std::move(model), IsOfOneSize, &Block::Springs, values);
}

Model BreakingAway(const std::vector<Block>& blocks, Model model,
                   const Eigen::VectorXd& speeds) {
  // What a law of one size says of one that has two is the larger.
  constexpr double kSlides = 2.0 / 3.0;
  const auto values = [&](const Member& member,
                          const Block&) -> std::optional<Eigen::VectorXd> {
    const double speed = speeds[blocks[member.block].candidate->joint];
    if (!(speed > 0.0)) return std::nullopt;
    const double force = member.values[0];
    return Eigen::VectorXd{{kSlides * force, (1.0 - kSlides) * force, speed}};
  };
  return InForm(blocks, std::move(model), IsOfOneSize, &Block::BreaksAway, values);
}

Model InFormsOf(const std::vector<Block>& blocks, Model model, const Model& other) {
  for (Member& member : model) {
    const Block& own = blocks[member.block];
    if (!own.IsDryFriction()) continue;
    const auto form = std::ranges::find_if(other, [&](const Member& one) {
      return blocks[one.block].IsDryFriction() &&
             blocks[one.block].resists == own.resists;
    });
    if (form != other.end()) member = *form;
  }
  return model;
}

namespace {

/// The one that leaves the fewest members, of those that gain at least half as much as the
/// best: first order knows gains to a factor of two.
const ModelMove* SimplestOf(const Moves& moves,
                            const std::function<bool(const ModelMove&)>& may_be) {
  constexpr double kPart = 0.5;
  const auto more = [](const ModelMove& move) {
    return std::ssize(move.added) - std::ssize(move.removed);
  };
  const ModelMove* simplest = nullptr;
  double most = 0.0;
  for (const ModelMove& move : moves.best) {
    if (!may_be(move)) continue;
    const double gain = moves.score - move.score;
    most = std::max(most, gain);
    if (gain < kLeastGain || gain < kPart * most) break;
    if (simplest == nullptr || more(move) < more(*simplest)) simplest = &move;
  }
  return simplest;
}

}  // namespace

namespace {

/// Whether it takes out the same and brings in all that another one does.
bool DoesAllOf(const ModelMove& move, const ModelMove& other) {
  if (move.removed != other.removed) return false;
  std::multiset<std::size_t> brings;
  for (const Added& added : move.added) brings.insert(added.variation.block);
  return std::ranges::all_of(other.added, [&](const Added& added) {
    const auto one = brings.find(added.variation.block);
    if (one == brings.end()) return false;
    brings.erase(one);
    return true;
  });
}

/// Whether one with fewer members gains all but what is of second order of it.
bool IsNextToSimpler(const ModelMove& move, const Moves& moves) {
  constexpr double kShare = 0.05;
  const double gain = moves.score - move.score;
  return std::ranges::any_of(moves.best, [&](const ModelMove& other) {
    return other.added.size() < move.added.size() && DoesAllOf(move, other) &&
           moves.score - other.score > (1.0 - kShare) * gain;
  });
}

}  // namespace

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
    // What is worth less with more comes in later, if at all.
    if (std::ranges::any_of(
            chosen,
            [&](const ModelMove* better) { return DoesAllOf(move, *better); }) ||
        IsNextToSimpler(move, moves)) {
      continue;
    }
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
  const ModelMove* simplest = SimplestOf(moves, may_be);
  if (simplest != nullptr && std::ranges::find(chosen, simplest) == chosen.end()) {
    chosen.push_back(simplest);
  }
  return chosen;
}

}  // namespace mjdiag
