#include "mjdiag/discovery/fitting/wave_period.h"

#include <algorithm>
#include <utility>

#include "mjdiag/discovery/fitting/screening_in_place.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// Periods that are fitted.
constexpr int kMostPeriods = 4;

}  // namespace

bool HasPeriod(const Candidate& candidate) {
  return std::ranges::any_of(candidate.parameters, IsPeriod, &FitParameter::role);
}

std::vector<FittedCause> OtherPeriods(const DiscoveryProblem& problem,
                                      const std::vector<Candidate>& candidates,
                                      const CauseFit& fit, std::size_t i) {
  // Where nothing but noise is left no resonance is better; of waves, which are sharp,
  // the right one may still be.
  constexpr double kLeft = 1.005;
  const Candidate& wave = candidates[fit.causes[i].candidate];
  const bool sharp =
      PlaceOf(wave, Role::kPhase) < static_cast<Index>(wave.parameters.size());
  if (!sharp && fit.train < kLeft) return {};
  const auto innovations = InnovationsWithout(problem, candidates, fit, {i});
  if (!innovations) return {};
  const DiscoveryProblem seen = problem.TrainPart();
  const double present = fit.causes[i].value[PeriodPlace(wave)];
  const auto run = seen.Linearised(ChangesOf(seen, candidates, fit));
  const auto& [track, dynamics] = *run;
  std::vector<FittedCause> others;
  for (Start& start :
       BetterWaves(seen, wave, present, seen.MotionOf(track), dynamics, *innovations,
                   JacobianWithout(fit, {i}), ModelWithout(fit, {i}), kMostPeriods)) {
    start.cause.candidate = fit.causes[i].candidate;
    others.push_back(Bounded(candidates, std::move(start.cause)));
  }
  return others;
}

}  // namespace mjdiag
