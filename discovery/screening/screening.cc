#include "mjdiag/discovery/screening/screening.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "mjdiag/discovery/screening/screener.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The largest first, `count` of them.
void KeepBest(std::vector<Start>& starts, std::size_t count) {
  std::ranges::stable_sort(starts, std::greater<>(), &Start::gain);
  if (starts.size() > count) starts.resize(count);
}

/// What is left of a gain G where the sizes that it takes cost P beforehand: with
/// amplitudes as large as they would be best and known to 1 / G of their square,
/// G / (G + P).
double Plausible(const std::vector<Candidate>& candidates, const Start& start,
                 double prior_weight) {
  const double cost = prior_weight * SizePriorOf(candidates, start.cause);
  return start.gain / (start.gain + cost);
}

}  // namespace

Screening Screen(const DiscoveryProblem& problem,
                 const std::vector<Candidate>& candidates, const ObservedMotion& motion,
                 const ErrorDynamics& dynamics, const VectorXd& residual,
                 const MatrixXd& jacobian, const FittedModel& present,
                 int starts_each) {
  const Screener screener(problem, dynamics, residual, jacobian, present);
  std::vector<std::vector<Start>> found(candidates.size());
  std::vector<int> tried(candidates.size());
  ParallelFor(static_cast<int>(candidates.size()), [&](int number) {
    const auto c = static_cast<std::size_t>(number);
    const Candidate& candidate = candidates[c];
    std::vector<Trial> trials;
    if (const auto sweep =
            MakeSweep(problem.machine(), candidate, motion, problem.FittedDuration())) {
      tried[c] = static_cast<int>(sweep->values.size());
      trials =
          screener.BestOf(*sweep, candidate, screener.RoughGains(*sweep, candidate));
    } else {
      trials = MakeTrials(problem.machine(), candidate, motion);
      tried[c] = static_cast<int>(trials.size());
    }
    for (auto& start : screener.Judge(trials, candidate)) {
      if (start) found[c].push_back(std::move(*start));
    }
    for (Start& start : found[c]) {
      start.cause.candidate = c;
      start.gain *= Plausible(candidates, start, present.prior_weight);
    }
    KeepBest(found[c], static_cast<std::size_t>(starts_each));
  });
  Screening screening;
  screening.rest = screener.Rest();
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    screening.trials += tried[c];
    screening.starts.insert(screening.starts.end(), found[c].begin(), found[c].end());
  }
  KeepBest(screening.starts, screening.starts.size());
  return screening;
}

Screening ScreenBeside(const DiscoveryProblem& problem,
                       const std::vector<Candidate>& candidates,
                       const FittedModel& present, const MatrixXd& jacobian,
                       int starts_each) {
  const DiscoveryProblem seen = problem.TrainPart();
  const auto run = seen.Linearised(ChangesOf(seen, candidates, present));
  const auto& [track, dynamics] = *run;
  return Screen(seen, candidates, seen.MotionOf(track), dynamics, seen.Scaled(track),
                jacobian, present, starts_each);
}

std::vector<Start> BetterWaves(const DiscoveryProblem& problem, const Candidate& wave,
                               double present, const ObservedMotion& motion,
                               const ErrorDynamics& dynamics, const VectorXd& residual,
                               const MatrixXd& jacobian, const FittedModel& beside,
                               int most) {
  const Screener screener(problem, dynamics, residual, jacobian, beside);
  double gain = 0.0;
  std::vector<Trial> trials;
  if (const auto sweep =
          MakeSweep(problem.machine(), wave, motion, problem.FittedDuration())) {
    constexpr std::size_t kPeaks = 40;
    const auto now = screener.Judge({sweep->make(present)}, wave).front();
    gain = now ? now->gain : 0.0;
    for (const double place : screener.Peaks(*sweep, wave, kPeaks)) {
      trials.push_back(sweep->make(screener.ValueAt(*sweep, place)));
    }
  } else {
    trials = MakeTrials(problem.machine(), wave, motion);
  }
  std::vector<Start> starts;
  for (auto& start : screener.Judge(trials, wave)) {
    if (start && start->gain > gain) starts.push_back(std::move(*start));
  }
  KeepBest(starts, starts.size());
  // Neighbours climb the same peak.
  const Index period = PeriodPlace(wave);
  std::vector<Start> distinct;
  for (Start& start : starts) {
    const bool known = std::ranges::any_of(distinct, [&](const Start& other) {
      constexpr double kSame = 0.01;
      return std::abs(start.cause.value[period] / other.cause.value[period] - 1.0) <
             kSame;
    });
    if (!known) distinct.push_back(std::move(start));
    if (static_cast<int>(distinct.size()) == most) break;
  }
  return distinct;
}

}  // namespace mjdiag
