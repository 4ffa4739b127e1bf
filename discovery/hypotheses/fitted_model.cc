#include "mjdiag/discovery/hypotheses/fitted_model.h"

namespace mjdiag {

Changes ChangesOf(const DiscoveryProblem& problem,
                  const std::vector<Candidate>& candidates, const FittedModel& model) {
  return problem.WithNumbers(ChangesOf(candidates, model.causes), model.numbers);
}

}  // namespace mjdiag
