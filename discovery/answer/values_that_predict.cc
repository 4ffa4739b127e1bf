#include "mjdiag/discovery/answer/values_that_predict.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;

namespace {

/// Behind which nothing lasts: latent forces as large as what is missing, new in every tick.
FilterNoise OfQuickForces(const FilterPath& path) {
  constexpr double kNothing = 1e-6;
  FilterNoise noise = path.noise;
  const auto samples = static_cast<double>(path.samples());
  for (Index j = 0; j < path.dof_count(); ++j) {
    const double rms = path.forces.row(j).norm() / std::sqrt(samples);
    noise.white[j] = std::max(noise.white[j], rms);
    noise.size[j] *= kNothing;
  }
  return noise;
}

/// Mean logarithm of the errors of one over those of another, over the longest horizon
/// within that of answers that both stay with.
double LogRatio(const Prediction& one, const Prediction& other) {
  double ratio = 0.0;
  const std::size_t horizons = std::min(one.horizons.size(), other.horizons.size());
  for (std::size_t h = 0; h < horizons && IsWithinHorizon(one.horizons[h]); ++h) {
    double sum = 0.0;
    for (std::size_t i = 0; i < one.sensors.size(); ++i) {
      const auto place = static_cast<Index>(h);
      sum += std::log(one.sensors[i].rms[place] / other.sensors[i].rms[place]);
    }
    if (std::isfinite(sum)) ratio = sum / static_cast<double>(one.sensors.size());
  }
  return ratio;
}

/// Behind the noise of the answer, or from there on where the machine does not stay with that.
FilterPath Followed(const Machine& machine, const MeasuredRun& run,
                    const Eigen::VectorXd& reading_sd, const FilterPath& as_answer,
                    const std::function<bool()>& is_over) {
  try {
    return RunForceFilter(machine, run, as_answer.dofs, as_answer.starts,
                          as_answer.noise);
  } catch (const NumericalError&) {
    return FilterLikeliestFrom(machine, run, reading_sd, as_answer.dofs,
                               {as_answer.noise}, is_over);
  }
}

}  // namespace

std::optional<BetterValues> WithValuesThatPredict(
    const AnswerData& data, const ModelOnRuns& answer, const FilterNoise& given,
    const std::function<bool()>& is_over) {
  constexpr int kIterations = 6;
  constexpr double kLeast = 0.05;  // what 200 predictions tell a ratio of rms to
  if (answer.fit.model.empty()) return std::nullopt;
  try {
    const KeptGains gains = KeepGains(answer.seen, OfQuickForces(answer.seen),
                                      OverdispersionAlong(answer.seen));
    BetterValues better;
    ModelOnRuns& other = better.answer;
    other.fit =
        FitModel(InTime([&](const Model& model) { return data.With(model); }, is_over),
                 data.run.seen, answer.seen, gains, data.blocks, answer.fit.model,
                 {kIterations}, FittedValues::kSizes);
    for (const Member& member : other.fit.model) {
      if (!IsAllowed(data.blocks[member.block], member.values)) return std::nullopt;
    }
    const Machine machine = data.With(other.fit.model);
    other.seen =
        Followed(machine, data.run.seen, data.reading_sd, answer.seen, is_over);
    other.unseen =
        Followed(machine, data.run.unseen, data.reading_sd, answer.unseen, is_over);
    better.log_ratio = -std::numeric_limits<double>::infinity();
    for (const bool of_seen : {true, false}) {
      const double ratio = LogRatio(PredictionOf(data, other, of_seen),
                                    PredictionOf(data, answer, of_seen));
      better.log_ratio = std::max(better.log_ratio, ratio);
    }
    if (!(better.log_ratio < -kLeast)) return std::nullopt;
    other.seen = FilterLikelier(machine, data.run.seen, data.reading_sd,
                                std::move(other.seen), is_over);
    FollowUnseen(data, given, is_over, other);
    return better;
  } catch (const NumericalError&) {
  } catch (const InputError&) {
  }
  return std::nullopt;
}

}  // namespace mjdiag
