#include "mjdiag/discovery/answer/model_on_runs.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// Latent forces that are no smaller than so much of what others are.
FilterNoise AtLeast(FilterNoise noise, double part, const FilterNoise& others) {
  for (Eigen::Index j = 0; j < noise.size.size(); ++j) {
    if (noise.size[j] >= part * others.size[j]) continue;
    noise.size[j] = part * others.size[j];
    noise.memory[j] = others.memory[j];
  }
  return noise;
}

/// What fits did not see as a filter follows it, where it is likelier than what is known.
void TakeUnseen(const AnswerData& data, const std::function<FilterPath()>& followed,
                ModelOnRuns& one) {
  try {
    FilterPath path = followed();
    double deviance = path.deviance;
    if (data.run.GoesOn()) {
      // Up to there it is what the filter does in what fits saw.
      deviance -= RunForceFilter(data.With(one.fit.model), data.run.seen, path.dofs,
                                 path.starts, path.noise)
                      .deviance;
    }
    if (!(deviance < one.unseen_deviance)) return;
    one.unseen_deviance = deviance;
    one.unseen = std::move(path);
  } catch (const NumericalError&) {
  }
}

/// Values anew behind the gains of a path along what fits saw.
void Refit(const AnswerData& data, const Model& model, const FilterPath& path,
           const std::function<bool()>& is_over, ModelOnRuns& one) {
  constexpr int kIterations = 4;
  one.fit =
      FitModel(InTime([&](const Model& other) { return data.With(other); }, is_over),
               data.run.seen, path, KeepGains(path), data.blocks, model, {kIterations});
  one.seen = RunForceFilter(data.With(one.fit.model), data.run.seen, path.dofs,
                            path.starts, path.noise);
}

std::vector<FilterStart> UnseenStarts(const AnswerData& data, const ModelOnRuns& one) {
  if (data.run.GoesOn()) return one.seen.starts;
  return FilterStarts(data.With(one.fit.model), data.run.unseen, data.reading_sd);
}

/// Along what fits did not see, behind the likeliest of some noises.
void FollowUnseenBehind(const std::vector<FilterNoise>& noises, const AnswerData& data,
                        const IsTimeOver& is_over, ModelOnRuns& one) {
  const Machine machine = data.With(one.fit.model);
  const std::vector<FilterStart> starts = UnseenStarts(data, one);
  one.unseen_deviance = std::numeric_limits<double>::infinity();
  for (const FilterNoise& noise : noises) {
    if (std::isfinite(one.unseen_deviance) && is_over()) break;
    TakeUnseen(
        data,
        [&] {
          return RunForceFilter(machine, data.run.unseen, one.seen.dofs, starts, noise);
        },
        one);
  }
  if (!std::isfinite(one.unseen_deviance)) {
    throw NumericalError("replay: diverges on unseen data");
  }
}

/// The same behind the likeliest noise, from one and from one that follows anything.
void FollowUnseenFrom(const AnswerData& data, const FilterNoise& near,
                      const IsTimeOver& is_over, ModelOnRuns& one) {
  TakeUnseen(
      data,
      [&] {
        return FilterLikeliestFrom(data.With(one.fit.model), data.run.unseen,
                                   data.reading_sd, one.seen.dofs, {near}, is_over);
      },
      one);
}

}  // namespace

void FollowUnseen(const AnswerData& data, const FilterNoise& given,
                  const std::function<bool()>& is_over, ModelOnRuns& one) {
  std::vector<FilterNoise> noises{one.seen.noise};
  const FilterNoise larger = AtLeast(one.seen.noise, 1e-2, given);
  if (larger.size != one.seen.noise.size) noises.push_back(larger);
  FollowUnseenBehind(noises, data, is_over, one);
  if (!is_over()) FollowUnseenFrom(data, one.unseen.noise, is_over, one);
}

ModelOnRuns RefittedByPieces(const AnswerData& data, const Model& model,
                             const std::vector<const ModelOnRuns*>& others,
                             const std::function<bool()>& is_over) {
  std::vector<FilterNoise> near;
  std::vector<FilterNoise> near_unseen;
  for (const ModelOnRuns* other : others) {
    near.push_back(other->seen.noise);
    near_unseen.push_back(other->unseen.noise);
  }
  ModelOnRuns one;
  Refit(data, model,
        FilterLikeliestFrom(data.With(model), data.run.seen, data.reading_sd,
                            others.front()->seen.dofs, near, is_over, NoiseBy::kPieces),
        is_over, one);
  near_unseen.push_back(one.seen.noise);
  FollowUnseenBehind(near_unseen, data, is_over, one);
  return one;
}

ModelOnRuns RefittedAlong(const FilterPath& like, const AnswerData& data,
                          const Model& model, const std::function<bool()>& is_over) {
  ModelOnRuns one;
  Refit(data, model, like, is_over, one);
  return one;
}

ModelOnRuns Refined(const AnswerData& data, ModelOnRuns by_pieces,
                    const FilterNoise& given, const std::function<bool()>& is_over) {
  ModelOnRuns one = std::move(by_pieces);
  const Model model = one.fit.model;
  const FilterPath path = FilterLikelier(data.With(model), data.run.seen,
                                         data.reading_sd, std::move(one.seen), is_over);
  Refit(data, model, path, is_over, one);
  FollowUnseen(data, given, is_over, one);
  return one;
}

ModelOnRuns NothingOf(const AnswerData& data, const Explained& explained,
                      const std::function<bool()>& is_over) {
  ModelOnRuns nothing;
  // Of an empty model the search has it with the physics steps that it chose.
  const bool as_given = data.steps.AreGiven() && explained.input_width == 0.0;
  nothing.seen = explained.fit.model.empty() ? explained.path
                 : as_given
                     ? explained.nothing
                     : FilterLikeliestFrom(data.With({}), data.run.seen,
                                           data.reading_sd, explained.nothing.dofs,
                                           {explained.nothing.noise}, is_over);
  try {
    FollowUnseen(data, nothing.seen.noise, is_over, nothing);
  } catch (const NumericalError&) {
    // Behind the noise of what fits saw it does not stay with the rest.
    nothing.seen.noise =
        FilterLikeliest(data.With({}), data.run.unseen, data.reading_sd, is_over).noise;
    nothing.seen = RunForceFilter(data.With({}), data.run.seen, nothing.seen.dofs,
                                  nothing.seen.starts, nothing.seen.noise);
    FollowUnseen(data, nothing.seen.noise, is_over, nothing);
  }
  return nothing;
}

void LookBehindNoiseOf(const ModelOnRuns& other, const AnswerData& data,
                       const IsTimeOver& is_over, ModelOnRuns& one) {
  FollowUnseenFrom(data, other.unseen.noise, is_over, one);
  try {
    FilterPath path =
        FilterLikeliestNear(data.With(one.fit.model), data.run.seen, data.reading_sd,
                            one.seen.dofs, other.seen.noise, is_over);
    if (path.deviance < one.seen.deviance) one.seen = std::move(path);
  } catch (const NumericalError&) {
  }
}

Prediction PredictionOf(const AnswerData& data, const ModelOnRuns& one, bool of_seen) {
  const Eigen::Index skip = data.machine.setup().compare.skip_samples;
  const MeasuredRun& run = of_seen ? data.run.seen : data.run.unseen;
  std::vector<Eigen::Index> skips;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    skips.push_back(of_seen ? std::min(skip, run.SamplesOf(r) / 2)
                            : std::max(skip, data.run.seen_of[r]));
  }
  return Predict(data.With(one.fit.model), run, of_seen ? one.seen : one.unseen, skips);
}

}  // namespace mjdiag
