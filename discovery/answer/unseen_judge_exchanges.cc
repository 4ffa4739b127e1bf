// What could be in the place of members of the answer (unseen_judge.h).

#include <algorithm>
#include <utility>

#include "mjdiag/discovery/answer/unseen_judge.h"
#include "mjdiag/discovery/regression/moves.h"

namespace mjdiag {

using Eigen::VectorXd;

/// Whether a block may be in a place beside the other members.
bool UnseenJudge::IsFree(std::size_t block, std::size_t place) const {
  const Model& model = judged_.answer.fit.model;
  for (std::size_t m = 0; m < model.size(); ++m) {
    const Block& other = data_.blocks[model[m].block];
    if (model[m].block == block) return false;
    if (m == place || other.group.empty()) continue;
    if (other.group == data_.blocks[block].group) return false;
  }
  return true;
}

/// The likeliest that first order knows, and what is simpler; the one that an exchange has
/// put out.
std::vector<Instead> UnseenJudge::InsteadOf(std::size_t place) const {
  constexpr std::size_t kMost = 3;
  constexpr double kNearBy = 10.0;  // e^-5 as likely
  const Member& first = explained_.fit.model[judged_.places[place]];
  std::vector<Instead> instead;
  const auto add = [&](std::size_t block, VectorXd values) {
    const bool known = std::ranges::any_of(
        instead, [&](const Instead& one) { return one.block == block; });
    if (!known && IsFree(block, place)) instead.push_back({block, std::move(values)});
  };
  add(first.block, first.values);
  for (const ModelMove& move : explained_.rivals) {
    if (instead.size() == kMost || move.score > kNearBy) break;
    if (move.added.size() != 1 || move.removed != std::vector{judged_.places[place]}) {
      continue;
    }
    const Added& added = move.added.front();
    if (const RegressorValues values = added.variation.values(added.amplitudes)) {
      add(added.variation.block, *values);
    }
  }
  const Member& member = judged_.answer.fit.model[place];
  for (Instead& one : SimplerThan(member, data_.blocks, data_.machine.plant())) {
    add(one.block, std::move(one.values));
  }
  return instead;
}

bool UnseenJudge::ExchangeOne() {
  const Model model = judged_.answer.fit.model;
  std::optional<ModelOnRuns> best;
  double most = 0.0;
  double gained = 0.0;
  std::vector<std::pair<std::size_t, Instead>> exchanges;
  std::vector<Model> others;
  for (std::size_t m = 0; m < model.size(); ++m) {
    for (Instead& one : InsteadOf(m)) {
      others.push_back(model);
      others.back()[m] = {one.block, one.values};
      exchanges.emplace_back(m, std::move(one));
    }
  }
  std::vector<std::optional<ModelOnRuns>> fitted = RefittedAll(others);
  for (std::size_t i = 0; i < exchanges.size(); ++i) {
    if (!fitted[i]) continue;
    const auto& [m, one] = exchanges[i];
    MemberLoss loss = LossOf(*fitted[i]);
    if (loss.Total() < -kLeastGain) {
      if (is_over_()) continue;  // it was not looked at in the same way
      LookBehindNoiseOf(*fitted[i], data_, is_over_, judged_.answer);
      loss = LossOf(*fitted[i]);
    }
    const VectorXd& values = fitted[i]->fit.model[m].values;
    judged_.exchanges[m].push_back({one.block, values, loss});
    // The simpler one where it is as good.
    const bool is_simpler = one.values.size() < model[m].values.size();
    const double gain = (is_simpler ? kLeastGain : -kLeastGain) - loss.Total();
    if (!(gain > most)) continue;
    if (!IsAllowed(data_.blocks[one.block], values)) continue;
    most = gain;
    gained = -loss.Total();
    best = std::move(fitted[i]);
  }
  judged_.is_cut_short = judged_.is_cut_short || is_over_();
  if (!best) return false;
  Decide(Names(best->fit.model), -gained, "taken: one exchanged for a likelier one");
  judged_.answer = std::move(*best);
  return true;
}

}  // namespace mjdiag
