#include "mjdiag/discovery/answer/unseen_judgement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <utility>

#include "mjdiag/discovery/answer/member_forces.h"
#include "mjdiag/discovery/answer/unseen_judge.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

namespace {

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

}  // namespace

// That is known to what the noise of pieces does beside that of all: p / f of -2 ln L, by p of
// its numbers from a share f, some hundred; and to what lies between the noise of the answer and
// of the machine as given, less than half of the loss.
bool MemberLoss::IsBeyondDoubt() const {
  constexpr double kSomeHundred = 500.0;
  return seen > kSomeHundred && unseen > kSomeHundred;
}

bool MemberLoss::IsRefuted() const { return unseen < -kLeastGain || Total() < 0.0; }

void LeaveNothing(const std::vector<Block>& blocks, const std::string& why, double loss,
                  UnseenJudgement& judged) {
  const Model& model = judged.answer.fit.model;
  judged.decisions.push_back({ModelText(blocks, model), loss, why});
  for (const Member& member : model) {
    judged.refuted.push_back(ModelText(blocks, {member}));
  }
  judged.answer = judged.nothing;
  judged.places.clear();
  judged.losses.clear();
  judged.exchanges.clear();
}

std::vector<std::optional<ModelOnRuns>> UnseenJudge::RefittedAll(
    const std::vector<Model>& models) const {
  std::vector<std::optional<ModelOnRuns>> fitted(models.size());
  ParallelForAll(static_cast<int>(models.size()), [&](int number) {
    if (is_over_()) return;
    const auto m = static_cast<std::size_t>(number);
    if (models[m].empty()) {
      fitted[m] = judged_.nothing;
      return;
    }
    try {
      fitted[m] = RefittedByPieces(data_, models[m],
                                   {&judged_.answer, &judged_.nothing}, is_over_);
      if (LossOf(*fitted[m]).IsBeyondDoubt() || is_over_()) return;
      fitted[m] = Refined(data_, *fitted[m], judged_.nothing.seen.noise, is_over_);
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  });
  return fitted;
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
    LeaveNothing(data_.blocks, "left out: the machine with it diverges on unseen data",
                 kNeeded, judged_);
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
    LeaveNothing(
        data_.blocks,
        "left out: it predicts data that no fit saw no better than the plant as given",
        -gain, judged_);
  }
  return std::move(judged_);
}

UnseenJudgement JudgeUnseen(const AnswerData& data, Explained& explained,
                            const std::function<bool()>& is_over) {
  return UnseenJudge(data, explained, is_over).Run();
}

}  // namespace mjdiag
