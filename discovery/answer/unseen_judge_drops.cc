// Members that leave the answer (unseen_judge.h).

#include <algorithm>
#include <iterator>
#include <utility>

#include "mjdiag/discovery/answer/member_forces.h"
#include "mjdiag/discovery/answer/unseen_judge.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

std::optional<ModelOnRuns> UnseenJudge::SimplerInPlaceOf(
    std::size_t place, const ModelOnRuns& without) const {
  const Model& model = judged_.answer.fit.model;
  std::vector<Instead> instead =
      SimplerThan(model[place], data_.blocks, data_.machine.plant());
  std::ranges::move(SimplerResistances(model[place], data_.blocks),
                    std::back_inserter(instead));
  std::vector<Model> others;
  for (const Instead& one : instead) {
    if (!IsFree(one.block, place)) continue;
    others.push_back(model);
    others.back()[place] = {one.block, one.values};
  }
  std::optional<ModelOnRuns> best;
  for (std::optional<ModelOnRuns>& one : RefittedAll(others)) {
    if (!one) continue;
    const Member& member = one->fit.model[place];
    const MemberLoss loss{without.Score() - one->Score(),
                          without.unseen_deviance - one->unseen_deviance};
    if (loss.IsRefuted() || loss.Total() < kLeastGain) continue;
    if (!IsAllowed(data_.blocks[member.block], member.values)) continue;
    if (!best || one->Total() < best->Total()) best = std::move(one);
  }
  return best;
}

bool UnseenJudge::DropWorst() {
  const ModelOnRuns& answer = judged_.answer;
  const Model& model = answer.fit.model;
  judged_.losses.assign(model.size(), {kNeeded, kNeeded});
  judged_.exchanges.assign(model.size(), {});
  const std::vector<bool> idle = NobodyWouldMiss(data_, answer);
  std::vector<Model> others;
  std::vector<std::size_t> asked;
  for (std::size_t m = 0; m < model.size(); ++m) {
    if (needed_.contains(model[m].block) && !idle[m]) continue;
    others.push_back(Without(model, m));
    asked.push_back(m);
  }
  std::vector<std::optional<ModelOnRuns>> refitted = RefittedAll(others);
  std::vector<std::optional<ModelOnRuns>> without(model.size());
  for (std::size_t i = 0; i < asked.size(); ++i) {
    without[asked[i]] = std::move(refitted[i]);
  }
  std::optional<ModelOnRuns> best;
  std::size_t worst = 0;
  for (std::size_t m = 0; m < model.size(); ++m) {
    const auto needed = needed_.find(model[m].block);
    if (needed != needed_.end()) judged_.losses[m] = needed->second;
    // The machine does not run without it, or no time is left.
    if (!without[m]) continue;
    judged_.losses[m] = LossOf(*without[m]);
    if (judged_.losses[m].IsBeyondDoubt()) {
      needed_[model[m].block] = judged_.losses[m];
    }
    if (judged_.losses[m].IsRefuted()) {
      if (is_over_()) {
        // What was not looked at in the same way speaks against nothing.
        judged_.losses[m] = {kNeeded, kNeeded};
        continue;
      }
      LookBehindNoiseOf(*without[m], data_, is_over_, judged_.answer);
      judged_.losses[m] = LossOf(*without[m]);
    }
    const bool is_worst =
        !best || judged_.losses[m].Total() < judged_.losses[worst].Total();
    if ((idle[m] || judged_.losses[m].IsRefuted()) && is_worst) {
      worst = m;
      best = std::move(without[m]);
    }
  }
  judged_.is_cut_short = judged_.is_cut_short || is_over_();
  if (!best) return false;
  if (std::optional<ModelOnRuns> simpler = SimplerInPlaceOf(worst, *best)) {
    Decide(Names(simpler->fit.model), judged_.losses[worst].unseen,
           "taken: one exchanged for a simpler one, which holds on data that no fit "
           "saw, too");
    judged_.answer = std::move(*simpler);
    judged_.losses.clear();
    judged_.exchanges.clear();
    return true;
  }
  judged_.refuted.push_back(Names({model[worst]}));
  Decide("without " + Names({model[worst]}), judged_.losses[worst].unseen,
         judged_.losses[worst].IsRefuted()
             ? "left out: data that no fit saw are predicted as well without it"
             : "left out: its force is less than a hundredth of what is missing");
  judged_.answer = std::move(*best);
  judged_.places.erase(judged_.places.begin() + static_cast<std::ptrdiff_t>(worst));
  judged_.losses.clear();
  judged_.exchanges.clear();
  return true;
}

}  // namespace mjdiag
