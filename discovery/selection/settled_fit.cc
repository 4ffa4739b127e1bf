#include "mjdiag/discovery/selection/settled_fit.h"

#include <algorithm>
#include <utility>

#include "mjdiag/discovery/selection/model_choice.h"

namespace mjdiag {

CauseFit Settled(const DiscoveryProblem& problem,
                 const std::vector<Candidate>& candidates, CauseFit fit, double share) {
  constexpr int kMost = 5;
  constexpr int kSteps = 6;  // by secants, which tell apart what acts alike
  constexpr double kUnit = 1.0;
  const double values = FittedValues(problem);
  double left = share - fit.spent;
  for (int i = 0; i < kMost && fit.numbers.size() + std::ssize(fit.causes) > 0; ++i) {
    if (left < fit.spent) break;  // a round takes about as much as the one before
    fit.prior_weight = Inflation(fit.train, IndependentShare(problem, fit.residual));
    const double weight = fit.prior_weight;
    const auto squares = [&](const CauseFit& one) {
      return values * one.train + weight * one.prior;
    };
    const double before = squares(fit);
    FitOptions options = CompareFrom(nullptr, kSteps, 0.1 * kUnit / values, left);
    options.only_betters = true;
    auto next = TryFit(problem, candidates, fit, options);
    if (!next || !(squares(*next) < before)) break;
    left -= next->spent;
    const double gained = before - squares(*next);
    fit = std::move(*next);
    if (gained < kUnit * weight) break;
  }
  return fit;
}

}  // namespace mjdiag
