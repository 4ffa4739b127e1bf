#include "mjdiag/discovery/wave_period.h"

#include <algorithm>
#include <optional>

#include "mjdiag/discovery/screening.h"
#include "mjdiag/plugin/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Periods that are fitted.
constexpr int kMostPeriods = 4;

std::vector<Start> ScreenAgain(const DiscoveryProblem& problem,
                               const std::vector<Candidate>& candidates,
                               const CauseFit& fit, std::size_t i) {
  constexpr double kStep = 1e-3;
  const DiscoveryProblem seen = Beginning(problem, problem.train);
  std::vector<FittedCause> causes = fit.causes;
  const Candidate& wave = candidates[causes[i].candidate];
  for (std::size_t k = 0; k < wave.parameters.size(); ++k) {
    if (wave.parameters[k].name != "amplitude") continue;
    causes[i].value[static_cast<Index>(k)] *= 1.0 + kStep;
  }
  const VectorXd left = fit.residual.head(seen.run.outputs.size());
  const VectorXd moved = seen.Residual(ChangesOf(candidates, causes));
  const auto [track, dynamics] = seen.Linearised(ChangesOf(candidates, fit.causes));
  std::vector<Start> starts = ScreenWave(
      seen, wave, ObserveMotion(*seen.plant, seen.run, track), dynamics,
      left - (moved - left) / kStep, SensitivitiesWithout(fit, i), kMostPeriods);
  for (Start& start : starts) start.candidate = causes[i].candidate;
  return starts;
}

}  // namespace

bool IsWave(const Candidate& candidate) {
  return std::ranges::any_of(candidate.parameters, [](const FitParameter& parameter) {
    return parameter.name == "phase";
  });
}

std::vector<CauseFit> FitOtherPeriods(const DiscoveryProblem& problem,
                                      const std::vector<Candidate>& candidates,
                                      const CauseFit& fit, std::size_t i) {
  const std::vector<Start> starts = ScreenAgain(problem, candidates, fit, i);
  std::vector<std::optional<CauseFit>> tried(starts.size());
  ParallelFor(static_cast<int>(starts.size()), [&](int number) {
    const auto k = static_cast<std::size_t>(number);
    std::vector<FittedCause> causes = fit.causes;
    causes[i] = FittedFrom(candidates, starts[k]);
    tried[k] = TryFit(problem, candidates, causes, CompareFrom(nullptr, 8, 1e-4));
  });
  std::vector<CauseFit> fits;
  for (auto& other : tried) {
    if (other) fits.push_back(std::move(*other));
  }
  return fits;
}

}  // namespace mjdiag
