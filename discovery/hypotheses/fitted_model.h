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
  FittedModel(std::vector<FittedCause> found, Eigen::VectorXd z = {},
              double weight = 1.0)
      : causes(std::move(found)), numbers(std::move(z)), prior_weight(weight) {}

  std::vector<FittedCause> causes;
  Eigen::VectorXd numbers;  ///< z; empty: all at 0
  /// What is known beforehand counts that much more than one innovation does: what a
  /// model leaves is larger than noise, and few of its values are independent.
  double prior_weight = 1.0;
};

/// How probable it is that a model lacks an effect of odds 1 at a site where the machine
/// has it: models are made by people who know their machine.
inline constexpr double kMissing = 0.1;

/// Sum of squares of the sizes of a cause over their spread.
double SizePriorOf(const std::vector<Candidate>& candidates, const FittedCause& cause);
/// Whether its sizes are within three standard deviations of what machines have. Beside a
/// rest far above noise, which no model explains, a fit is no evidence for more.
bool IsPlausible(const std::vector<Candidate>& candidates, const FittedCause& cause);
/// Sum of squares of z and of the sizes of the causes over their spread, and of the
/// causes -2 log(kMissing odds): -2 log of what is known beforehand, but for a constant.
double PriorOf(const std::vector<Candidate>& candidates, const FittedModel& model);

/// What it does to the plant.
Changes ChangesOf(const DiscoveryProblem& problem,
                  const std::vector<Candidate>& candidates, const FittedModel& model);

/// The model with the first of its causes, with the first two, and so on to all.
std::vector<FittedModel> LadderOf(const FittedModel& model);

}  // namespace mjdiag
