#include "mjdiag/discovery/fitting/wave_period.h"

#include <algorithm>
#include <functional>
#include <string>

#include "mjdiag/discovery/screening/screening.h"

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

}  // namespace

bool HasPeriod(const Candidate& candidate) {
  return std::ranges::any_of(candidate.parameters, [](const FitParameter& parameter) {
    return parameter.name == "period" || parameter.name == "frequency";
  });
}

std::vector<FittedCause> OtherPeriods(const DiscoveryProblem& problem,
                                      const std::vector<Candidate>& candidates,
                                      const CauseFit& fit, std::size_t i) {
  // Where nothing but noise is left no resonance is better; of waves, which are sharp,
  // the right one may still be.
  constexpr double kLeft = 1.005;
  constexpr double kStep = 1e-3;
  std::vector<FittedCause> causes = fit.causes;
  const Candidate& wave = candidates[causes[i].candidate];
  const bool sharp =
      PlaceOf(wave, {"phase"}) < static_cast<Index>(wave.parameters.size());
  if (!sharp && fit.train < kLeft) return {};
  const DiscoveryProblem seen = Beginning(problem, problem.train);
  const double present = causes[i].value[PlaceOf(wave, {"period", "frequency"})];
  causes[i].value[PlaceOf(wave, {"amplitude", "mass"})] *= 1.0 + kStep;
  const VectorXd left = fit.residual.head(seen.run.outputs.size());
  const VectorXd moved = seen.Residual(ChangesOf(candidates, causes));
  const auto [track, dynamics] = seen.Linearised(ChangesOf(candidates, fit.causes));
  std::vector<FittedCause> others;
  for (Start& start : BetterWaves(
           seen, wave, present, ObserveMotion(seen.machine, seen.run, track), dynamics,
           left - (moved - left) / kStep, JacobianWithout(fit, i), kMostPeriods)) {
    start.candidate = causes[i].candidate;
    others.push_back(FittedFrom(candidates, start));
  }
  return others;
}

}  // namespace mjdiag
