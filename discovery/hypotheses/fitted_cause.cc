#include "mjdiag/discovery/hypotheses/fitted_cause.h"

#include <utility>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

Cause CauseOf(const std::vector<Candidate>& candidates, const FittedCause& fitted) {
  const Candidate& candidate = candidates[fitted.candidate];
  VectorXd values =
      VectorXd::Zero(static_cast<Index>(candidate.effect->parameters().size()));
  const Index choices = candidate.chosen.size();
  values.head(choices) = candidate.chosen;
  values.segment(choices, fitted.value.size()) = fitted.value;
  return {candidate.effect, candidate.site, std::move(values)};
}

Changes ChangesOfFit(const std::vector<Candidate>& candidates,
                     const std::vector<FittedCause>& causes) {
  std::vector<Cause> list;
  list.reserve(causes.size());
  for (const FittedCause& fitted : causes) {
    list.push_back(CauseOf(candidates, fitted));
  }
  return ChangesOf(list);
}

}  // namespace mjdiag
