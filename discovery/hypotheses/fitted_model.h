#pragma once
// What a fit says of a machine: causes, and the numbers of its plant beside them
// (DiscoveryProblem::numbers).

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "mjdiag/discovery/hypotheses/fitted_cause.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

struct FittedModel {
  FittedModel() = default;
  FittedModel(std::vector<FittedCause> found, Eigen::VectorXd z = {})
      : causes(std::move(found)), numbers(std::move(z)) {}

  std::vector<FittedCause> causes;
  Eigen::VectorXd numbers;  ///< z; empty: all at 0
};

/// What it does to the plant.
Changes ChangesOf(const DiscoveryProblem& problem,
                  const std::vector<Candidate>& candidates, const FittedModel& model);

}  // namespace mjdiag
