#include "mjdiag/discovery/wave_period.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include "mjdiag/discovery/screening.h"
#include "mjdiag/plugin/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Periods that are fitted.
constexpr int kMostPeriods = 4;

/// Place of the parameter with one of those names.
Index PlaceOf(const Candidate& wave, const std::vector<std::string>& names) {
  const auto found = std::ranges::find_first_of(wave.parameters, names,
                                                std::equal_to<>(), &FitParameter::name);
  return found - wave.parameters.begin();
}

std::vector<Start> ScreenAgain(const DiscoveryProblem& problem,
                               const std::vector<Candidate>& candidates,
                               const CauseFit& fit, std::size_t i) {
  constexpr double kStep = 1e-3;
  const DiscoveryProblem seen = Beginning(problem, problem.train);
  std::vector<FittedCause> causes = fit.causes;
  const Candidate& wave = candidates[causes[i].candidate];
  causes[i].value[PlaceOf(wave, {"amplitude", "mass"})] *= 1.0 + kStep;
  const VectorXd left = fit.residual.head(seen.run.outputs.size());
  const VectorXd moved = seen.Residual(ChangesOf(candidates, causes));
  const auto [track, dynamics] = seen.Linearised(ChangesOf(candidates, fit.causes));
  const double present = causes[i].value[PlaceOf(wave, {"period", "frequency"})];
  std::vector<Start> starts = BetterWaves(
      seen, wave, present, ObserveMotion(*seen.plant, seen.run, track), dynamics,
      left - (moved - left) / kStep, SensitivitiesWithout(fit, i), kMostPeriods);
  for (Start& start : starts) start.candidate = causes[i].candidate;
  return starts;
}

}  // namespace

bool HasPeriod(const Candidate& candidate) {
  return std::ranges::any_of(candidate.parameters, [](const FitParameter& parameter) {
    return parameter.name == "period" || parameter.name == "frequency";
  });
}

std::vector<CauseFit> FitOtherPeriods(const DiscoveryProblem& problem,
                                      const std::vector<Candidate>& candidates,
                                      const CauseFit& fit, std::size_t i) {
  // Where nothing but noise is left no resonance is better; of waves, which are sharp,
  // the right one may still be.
  constexpr double kLeft = 1.005;
  const Candidate& candidate = candidates[fit.causes[i].candidate];
  const bool wave =
      PlaceOf(candidate, {"phase"}) < static_cast<Index>(candidate.parameters.size());
  if (!wave && fit.train < kLeft) return {};
  const std::vector<Start> starts = ScreenAgain(problem, candidates, fit, i);
  std::vector<std::optional<CauseFit>> tried(starts.size());
  // Sensitivities of the others are known, if they come first.
  const Eigen::MatrixXd others = SensitivitiesWithout(fit, i);
  const bool last = i + 1 == fit.causes.size();
  ParallelFor(static_cast<int>(starts.size()), [&](int number) {
    const auto k = static_cast<std::size_t>(number);
    std::vector<FittedCause> causes = fit.causes;
    causes[i] = FittedFrom(candidates, starts[k]);
    tried[k] =
        TryFit(problem, candidates, causes,
               CompareFrom(last && others.cols() > 0 ? &others : nullptr, 8, 1e-4));
  });
  std::vector<CauseFit> fits;
  for (auto& other : tried) {
    if (other) fits.push_back(std::move(*other));
  }
  return fits;
}

}  // namespace mjdiag
