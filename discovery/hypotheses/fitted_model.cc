#include "mjdiag/discovery/hypotheses/fitted_model.h"

#include <cmath>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

double SizePriorOf(const std::vector<Candidate>& candidates, const FittedCause& cause) {
  double sum = 0.0;
  Eigen::Index i = 0;
  for (const FitParameter& parameter : candidates[cause.candidate].parameters) {
    sum += std::pow((cause.value[i++] - parameter.nothing) / parameter.spread, 2);
  }
  return sum;
}

bool IsPlausible(const std::vector<Candidate>& candidates, const FittedCause& cause) {
  constexpr double kDeviations = 3.0;
  return SizePriorOf(candidates, cause) <= kDeviations * kDeviations;
}

double PriorOf(const std::vector<Candidate>& candidates, const FittedModel& model) {
  double sum = model.numbers.squaredNorm();
  for (const FittedCause& cause : model.causes) {
    const double odds = candidates[cause.candidate].effect->odds();
    sum += SizePriorOf(candidates, cause) - 2.0 * std::log(kMissing * odds);
  }
  return sum;
}

Changes ChangesOf(const DiscoveryProblem& problem,
                  const std::vector<Candidate>& candidates, const FittedModel& model) {
  return problem.WithNumbers(ChangesOf(candidates, model.causes), model.numbers);
}

std::vector<FittedModel> LadderOf(const FittedModel& model) {
  std::vector<FittedModel> ladder;
  for (std::size_t count = 1; count <= model.causes.size(); ++count) {
    const auto end = model.causes.begin() + static_cast<std::ptrdiff_t>(count);
    ladder.push_back({{model.causes.begin(), end}, model.numbers});
  }
  return ladder;
}

}  // namespace mjdiag
