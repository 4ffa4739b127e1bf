#include "mjdiag/discovery/answer/unseen_judgement.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

namespace {

constexpr double kNeeded = std::numeric_limits<double>::infinity();

FilterPath PathOfUnseen(const AnswerData& data, const Model& model,
                        const FilterPath& seen) {
  const Machine machine = data.With(model);
  return RunForceFilter(machine, data.run.unseen, seen.dofs,
                        FilterStarts(machine, data.run.unseen, data.reading_sd),
                        seen.noise);
}

/// Values and noise of a model anew.
ModelOnRuns Refitted(const AnswerData& data, const Model& model,
                     const std::vector<Eigen::Index>& dofs,
                     const std::vector<FilterNoise>& near) {
  constexpr int kIterations = 4;
  ModelOnRuns one;
  const FilterPath path =
      FilterLikeliestFrom(data.With(model), data.run.seen, data.reading_sd, dofs, near);
  one.fit =
      FitModel([&](const Model& other) { return data.With(other); }, data.run.seen,
               path, KeepGains(path), data.blocks, model, kIterations);
  one.seen = RunForceFilter(data.With(one.fit.model), data.run.seen, path.dofs,
                            path.starts, path.noise);
  one.unseen = PathOfUnseen(data, one.fit.model, one.seen);
  return one;
}

ModelOnRuns NothingOf(const AnswerData& data, const Explained& explained) {
  ModelOnRuns nothing;
  // Of an empty model the search has it with the physics steps that it chose.
  nothing.seen = explained.fit.model.empty() ? explained.path
                 : data.steps                ? explained.nothing
                                             : FilterLikeliestFrom(
                                                   data.With({}), data.run.seen, data.reading_sd,
                                                   explained.nothing.dofs, {explained.nothing.noise});
  try {
    nothing.unseen = PathOfUnseen(data, {}, nothing.seen);
  } catch (const NumericalError&) {
    // Behind the noise of what fits saw it does not stay with the rest.
    nothing.unseen = FilterLikeliest(data.With({}), data.run.unseen, data.reading_sd);
  }
  return nothing;
}

Model WithoutMember(Model model, std::size_t place) {
  model.erase(model.begin() + static_cast<std::ptrdiff_t>(place));
  return model;
}

/// That unseen data speak against it by more than fits are off, or that it is not worth its
/// price.
bool IsRefuted(const MemberLoss& loss) {
  return loss.unseen < -kLeastGain || loss.Total() < 0.0;
}

}  // namespace

UnseenJudgement JudgeUnseen(const AnswerData& data, const Explained& explained,
                            const std::function<bool()>& is_over) {
  UnseenJudgement judged;
  judged.nothing = NothingOf(data, explained);
  judged.answer = {explained.fit, explained.path, {}};
  judged.places.resize(explained.fit.model.size());
  std::iota(judged.places.begin(), judged.places.end(), std::size_t{0});
  const auto decide = [&](const std::string& tried, double score,
                          const std::string& why) {
    judged.decisions.push_back({tried, score, why});
  };
  const auto nothing_is_left = [&] {
    for (const Member& member : judged.answer.fit.model) {
      judged.refuted.push_back(Describe(data.blocks, {member}));
    }
    judged.answer = judged.nothing;
    judged.places.clear();
    judged.losses.clear();
  };
  if (explained.fit.model.empty()) {
    judged.answer.unseen = judged.nothing.unseen;
    return judged;
  }
  try {
    judged.answer.unseen = PathOfUnseen(data, explained.fit.model, explained.path);
  } catch (const NumericalError&) {
    decide(Describe(data.blocks, explained.fit.model), kNeeded,
           "left out: the machine with it diverges on unseen data");
    nothing_is_left();
    return judged;
  }
  while (!judged.answer.fit.model.empty()) {
    const ModelOnRuns& answer = judged.answer;
    const Model& model = answer.fit.model;
    judged.losses.assign(model.size(), {kNeeded, kNeeded});
    std::optional<ModelOnRuns> best;
    std::size_t worst = 0;
    for (std::size_t m = 0; m < model.size(); ++m) {
      if (is_over()) {
        judged.is_cut_short = true;
        break;
      }
      try {
        ModelOnRuns without = Refitted(data, WithoutMember(model, m), answer.seen.dofs,
                                       {answer.seen.noise, judged.nothing.seen.noise});
        judged.losses[m] = {without.Score() - answer.Score(),
                            without.unseen.deviance - answer.unseen.deviance};
        const bool is_worst =
            !best || judged.losses[m].Total() < judged.losses[worst].Total();
        if (IsRefuted(judged.losses[m]) && is_worst) {
          worst = m;
          best = std::move(without);
        }
      } catch (const NumericalError&) {
        // The machine does not run without it.
      } catch (const InputError&) {
      }
    }
    if (!best) break;
    judged.refuted.push_back(Describe(data.blocks, {model[worst]}));
    decide("without " + Describe(data.blocks, {model[worst]}),
           judged.losses[worst].unseen,
           "left out: data that no fit saw are predicted as well without it");
    judged.answer = std::move(*best);
    judged.places.erase(judged.places.begin() + static_cast<std::ptrdiff_t>(worst));
    if (judged.answer.fit.model.empty()) judged.losses.clear();
  }
  const double gain = judged.nothing.unseen.deviance - judged.answer.unseen.deviance;
  if (!judged.answer.fit.model.empty() && gain < kLeastGain) {
    decide(
        Describe(data.blocks, judged.answer.fit.model), -gain,
        "left out: it predicts data that no fit saw no better than the plant as given");
    nothing_is_left();
  }
  return judged;
}

}  // namespace mjdiag
