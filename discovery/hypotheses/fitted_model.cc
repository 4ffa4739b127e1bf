#include "mjdiag/discovery/hypotheses/fitted_model.h"

#include <cmath>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

double PriorOf(const std::vector<Candidate>& candidates, const FittedModel& model) {
  double sum = model.numbers.squaredNorm();
  for (const FittedCause& cause : model.causes) {
    const Candidate& candidate = candidates[cause.candidate];
    sum -= 2.0 * std::log(candidate.effect->odds());
    for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
      const FitParameter& parameter = candidate.parameters[i];
      const double off = cause.value[static_cast<Eigen::Index>(i)] - parameter.nothing;
      sum += std::pow(off / parameter.spread, 2);
    }
  }
  return sum;
}

Changes ChangesOf(const DiscoveryProblem& problem,
                  const std::vector<Candidate>& candidates, const FittedModel& model) {
  return problem.WithNumbers(ChangesOf(candidates, model.causes), model.numbers);
}

}  // namespace mjdiag
