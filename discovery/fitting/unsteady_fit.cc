#include "mjdiag/discovery/fitting/unsteady_fit.h"

#include <algorithm>
#include <array>
#include <limits>

#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Mean square of the train part with those values; infinite where they cannot be run.
double Left(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
            const FittedModel& model) {
  const auto fit =
      TryFit(problem, candidates, model, {.iterations = 0, .jacobian = false});
  return fit ? fit->train : std::numeric_limits<double>::infinity();
}

}  // namespace

double Unsteadiness(const DiscoveryProblem& problem,
                    const std::vector<Candidate>& candidates, const CauseFit& fit) {
  if (fit.causes.empty()) return 0.0;
  constexpr double kSpreads = 3.0;
  constexpr std::array<double, 2> kChanges = {1.0 + 1e-7, 1.0 - 1e-7};
  const DiscoveryProblem seen = problem.TrainPart();
  std::array<double, 2> left{};
  ParallelFor(2, [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    left[i] =
        Left(seen, candidates,
             {WithValues(fit.causes, kChanges[i] * Flatten(fit.causes)), fit.numbers});
  });
  const auto [least, most] = std::minmax({left[0], left[1], fit.train});
  return kSpreads * FittedValues(problem) * (most - least);
}

std::optional<CauseFit> LookAround(const DiscoveryProblem& problem,
                                   const std::vector<Candidate>& candidates,
                                   const CauseFit& fit, double least_gain) {
  constexpr std::array<double, 8> kSteps = {-0.1,  -0.03, -0.01, -0.003,
                                            0.003, 0.01,  0.03,  0.1};
  const DiscoveryProblem seen = problem.TrainPart();
  const VectorXd theta = Flatten(fit.causes);
  const auto parameters = ParametersOf(candidates, fit.causes);
  const std::size_t tries = parameters.size() * kSteps.size();
  if (!problem.work()->MayBegin("whether runs are repeatable",
                                static_cast<double>(tries) * seen.RunWork())) {
    return std::nullopt;
  }
  std::vector<VectorXd> places(tries, theta);
  std::vector<double> left(tries);
  ParallelFor(static_cast<int>(tries), [&](int number) {
    const auto k = static_cast<std::size_t>(number);
    const FitParameter& parameter = parameters[k / kSteps.size()];
    double& value = places[k][static_cast<Index>(k / kSteps.size())];
    value = std::clamp(value * (1.0 + kSteps[k % kSteps.size()]), parameter.lower,
                       parameter.upper);
    left[k] = Left(seen, candidates, {WithValues(fit.causes, places[k]), fit.numbers});
  });
  const auto best = std::ranges::min_element(left);
  if (FittedValues(problem) * (fit.train - *best) <= least_gain) return std::nullopt;
  const auto place = static_cast<std::size_t>(best - left.begin());
  return TryFit(problem, candidates,
                {WithValues(fit.causes, places[place]), fit.numbers, fit.prior_weight},
                {.iterations = 0});
}

}  // namespace mjdiag
