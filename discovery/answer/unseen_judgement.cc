#include "mjdiag/discovery/answer/unseen_judgement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "mjdiag/discovery/answer/member_forces.h"
#include "mjdiag/discovery/answer/simpler_blocks.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::VectorXd;

namespace {

constexpr double kNeeded = std::numeric_limits<double>::infinity();

/// Whether a loss is beyond doubt that is known to what the noise of pieces does beside that of
/// all: p / f of -2 ln L, by p of its numbers from a share f, some hundred; and to what lies
/// between the noise of the answer and of the machine as given, less than half of the loss.
bool IsBeyondDoubt(const MemberLoss& loss) {
  constexpr double kSome = 500.0;
  return loss.seen > kSome && loss.unseen > kSome;
}

/// That unseen data speak against it by more than fits are off, or that it is not worth its
/// price.
bool IsRefuted(const MemberLoss& loss) {
  return loss.unseen < -kLeastGain || loss.Total() < 0.0;
}

std::string WhyKept(const MemberLoss& loss, bool is_cut_short) {
  if (!std::isfinite(loss.unseen)) {
    return is_cut_short ? "kept: no time was left to ask data that no fit saw"
                        : "kept: no machine without it was found to follow the run";
  }
  char text[64];
  std::snprintf(text, sizeof text, "kept: %.1f of it on data that no fit saw",
                loss.unseen);
  return text;
}

class UnseenJudge {
 public:
  UnseenJudge(const AnswerData& data, Explained& explained,
              const std::function<bool()>& is_over)
      : data_(data), explained_(explained), is_over_(is_over) {}

  UnseenJudgement Run();

 private:
  void Decide(const std::string& tried, double score, const std::string& why) {
    judged_.decisions.push_back({tried, score, why});
  }
  std::string Names(const Model& model) const { return ModelText(data_.blocks, model); }
  void LeaveNothing();
  /// The model of the search is the answer, with all its members.
  void TakeExplained(ModelOnRuns answer);
  /// To where the search was when its model still held on what no fit saw.
  void GoBack();
  /// Takes out, at once, members of the model of the search that nobody would miss.
  void DropIdle();
  /// Follows unseen data beside the machine as given, and beside the answer.
  /// @return whether the machine stays with them with the answer
  bool FollowBoth();
  /// Values and noises of some models anew; none of one that the machine cannot be. Those that
  /// are beyond doubt worse than the answer by the noise of pieces only.
  std::vector<std::optional<ModelOnRuns>> RefittedAll(
      const std::vector<Model>& models) const;
  /// Takes every member out; true if the worst one leaves the model, or another one comes in
  /// its place.
  bool DropWorst();
  /// What is simpler in the place of a member, if it is worth more than nothing there: a law of
  /// the wrong shape may hold where it was found and nowhere else.
  std::optional<ModelOnRuns> SimplerInPlaceOf(std::size_t place,
                                              const ModelOnRuns& without) const;
  bool IsFree(std::size_t block, std::size_t place) const;
  std::vector<Instead> InsteadOf(std::size_t place) const;
  /// True if a member is exchanged.
  bool ExchangeOne();
  MemberLoss LossOf(const ModelOnRuns& other) const {
    return {other.Score() - judged_.answer.Score(),
            other.unseen_deviance - judged_.answer.unseen_deviance};
  }

  const AnswerData& data_;
  Explained& explained_;
  const std::function<bool()>& is_over_;
  UnseenJudgement judged_;
  /// Blocks of members whose loss is beyond doubt: the fewer others are left, the more.
  std::map<std::size_t, MemberLoss> needed_;
};

void UnseenJudge::LeaveNothing() {
  for (const Member& member : judged_.answer.fit.model) {
    judged_.refuted.push_back(Names({member}));
  }
  judged_.answer = judged_.nothing;
  judged_.places.clear();
  judged_.losses.clear();
  judged_.exchanges.clear();
}

std::vector<std::optional<ModelOnRuns>> UnseenJudge::RefittedAll(
    const std::vector<Model>& models) const {
  std::vector<std::optional<ModelOnRuns>> fitted(models.size());
  ParallelForAll(static_cast<int>(models.size()), [&](int number) {
    if (is_over_()) return;
    const auto m = static_cast<std::size_t>(number);
    try {
      fitted[m] = RefittedByPieces(data_, models[m],
                                   {&judged_.answer, &judged_.nothing}, is_over_);
      if (IsBeyondDoubt(LossOf(*fitted[m])) || is_over_()) return;
      fitted[m] = Refined(data_, *fitted[m], judged_.nothing.seen.noise, is_over_);
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  });
  return fitted;
}

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
    if (IsRefuted(loss) || loss.Total() < kLeastGain) continue;
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
    if (IsBeyondDoubt(judged_.losses[m])) {
      needed_[model[m].block] = judged_.losses[m];
    }
    if (IsRefuted(judged_.losses[m])) {
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
    if ((idle[m] || IsRefuted(judged_.losses[m])) && is_worst) {
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
         IsRefuted(judged_.losses[worst])
             ? "left out: data that no fit saw are predicted as well without it"
             : "left out: its force is less than a hundredth of what is missing");
  judged_.answer = std::move(*best);
  judged_.places.erase(judged_.places.begin() + static_cast<std::ptrdiff_t>(worst));
  judged_.losses.clear();
  judged_.exchanges.clear();
  return true;
}

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

void UnseenJudge::TakeExplained(ModelOnRuns answer) {
  judged_.answer = std::move(answer);
  judged_.places.resize(explained_.fit.model.size());
  std::iota(judged_.places.begin(), judged_.places.end(), std::size_t{0});
}

void UnseenJudge::GoBack() {
  std::optional<ModelOnRuns> best;
  for (auto step = explained_.steps_taken.rbegin();
       step != explained_.steps_taken.rend(); ++step) {
    if (step->fit.model.size() >= explained_.fit.model.size()) continue;
    try {
      ModelOnRuns one{step->fit,
                      RunForceFilter(data_.With(step->fit.model), data_.run.seen,
                                     judged_.nothing.seen.dofs, explained_.path.starts,
                                     step->noise),
                      {},
                      0.0};
      FollowUnseen(data_, judged_.nothing.seen.noise, is_over_, one);
      if (one.Total() < (best ? best->Total() : judged_.answer.Total())) {
        best = std::move(one);
      }
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
    if (is_over_()) break;
  }
  if (!best) return;
  Decide(Names(best->fit.model), best->Total() - judged_.answer.Total(),
         "taken: what the search added to it does not hold on data that no fit saw");
  explained_.fit = best->fit;
  explained_.path = best->seen;
  explained_.rivals.clear();
  TakeExplained(std::move(*best));
}

void UnseenJudge::DropIdle() {
  const Model& model = judged_.answer.fit.model;
  const std::vector<bool> idle = NobodyWouldMiss(data_, judged_.answer);
  Model others, left_out;
  std::vector<std::size_t> places;
  for (std::size_t m = 0; m < model.size(); ++m) {
    (idle[m] ? left_out : others).push_back(model[m]);
    if (!idle[m]) places.push_back(judged_.places[m]);
  }
  if (left_out.empty()) return;
  try {
    judged_.answer = RefittedAlong(judged_.answer.seen, data_, others, is_over_);
  } catch (const NumericalError&) {
    return;  // those that stay need what leaves, or no time is left
  }
  judged_.places = std::move(places);
  Decide("without " + Names(left_out), 0.0,
         "left out: its force is less than a hundredth of what is missing");
}

bool UnseenJudge::FollowBoth() {
  bool stays = true;
  ParallelForAll(2, [&](int number) {
    if (number == 0) {
      judged_.nothing = NothingOf(data_, explained_, is_over_);
      return;
    }
    try {
      FollowUnseen(data_, explained_.nothing.noise, is_over_, judged_.answer);
    } catch (const NumericalError&) {
      stays = false;
    }
  });
  return stays;
}

UnseenJudgement UnseenJudge::Run() {
  TakeExplained({explained_.fit, explained_.path, {}, 0.0});
  if (!explained_.fit.model.empty()) DropIdle();
  if (judged_.answer.fit.model.empty()) {
    judged_.nothing = NothingOf(data_, explained_, is_over_);
    judged_.answer = judged_.nothing;
    return std::move(judged_);
  }
  if (!FollowBoth()) {
    Decide(Names(explained_.fit.model), kNeeded,
           "left out: the machine with it diverges on unseen data");
    LeaveNothing();
    return std::move(judged_);
  }
  if (judged_.nothing.unseen_deviance - judged_.answer.unseen_deviance < kLeastGain) {
    GoBack();
  }
  // Each exchange gains; what went round would be noise of fits.
  for (int exchanges = 0;; ++exchanges) {
    while (!judged_.answer.fit.model.empty() && DropWorst()) {
    }
    constexpr int kMost = 4;
    if (exchanges == kMost || judged_.is_cut_short || !ExchangeOne()) break;
  }
  for (std::size_t m = 0; m < judged_.losses.size(); ++m) {
    const MemberLoss& loss = judged_.losses[m];
    Decide("without " + Names({judged_.answer.fit.model[m]}), loss.Total(),
           WhyKept(loss, judged_.is_cut_short));
  }
  const double gain = judged_.nothing.unseen_deviance - judged_.answer.unseen_deviance;
  if (!judged_.answer.fit.model.empty() && gain < kLeastGain) {
    Decide(
        Names(judged_.answer.fit.model), -gain,
        "left out: it predicts data that no fit saw no better than the plant as given");
    LeaveNothing();
  }
  return std::move(judged_);
}

}  // namespace

UnseenJudgement JudgeUnseen(const AnswerData& data, Explained& explained,
                            const std::function<bool()>& is_over) {
  return UnseenJudge(data, explained, is_over).Run();
}

}  // namespace mjdiag
