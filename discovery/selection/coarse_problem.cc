#include "mjdiag/discovery/selection/coarse_problem.h"

#include <algorithm>

#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// Squared innovations that chance may well explain beside what is left anyway.
double Insignificant(const DiscoveryProblem& problem, const VectorXd& residual) {
  constexpr double kByChance = 20.0;  // of white noise
  const double rest = MeanSquare(residual, problem.run().outputs.rows(), problem.skip(),
                                 problem.train());
  return kByChance * std::max(1.0, rest) /
         IndependentShare(problem, residual).minCoeff();
}

/// @param exact  innovations of the problem
bool IsNearTo(const VectorXd& exact, const DiscoveryProblem& coarse,
              const DiscoveryProblem& problem, const Changes& changes) {
  try {
    return (coarse.Residual(changes) - exact).squaredNorm() <
           Insignificant(problem, exact);
  } catch (const NumericalError&) {
    return false;
  }
}

}  // namespace

bool IsNear(const DiscoveryProblem& coarse, const DiscoveryProblem& problem,
            const Changes& changes) {
  return IsNearTo(problem.Residual(changes), coarse, problem, changes);
}

std::optional<DiscoveryProblem> Coarsen(const DiscoveryProblem& problem,
                                        const Changes& changes) {
  const int substeps = problem.machine().rates().substeps;
  if (substeps < 2) return std::nullopt;
  const VectorXd exact = problem.Residual(changes);
  for (int fewer = 1; fewer < std::min(substeps, 3); ++fewer) {
    DiscoveryProblem coarse = problem.WithSubsteps(fewer);
    if (IsNearTo(exact, coarse, problem, changes)) return coarse;
  }
  if (problem.numbers().empty()) return std::nullopt;
  constexpr double kOfNoise = 100.0;
  constexpr double kOfRest = 0.1;
  const double most =
      std::max(kOfNoise * Insignificant(problem, exact), kOfRest * exact.squaredNorm());
  for (int fewer = 1; fewer < std::min(substeps, 3); ++fewer) {
    const DiscoveryProblem coarse = problem.WithSubsteps(fewer);
    try {
      const VectorXd shift = exact - coarse.Residual(changes);
      if (shift.squaredNorm() < most) return coarse.Shifted(shift);
    } catch (const NumericalError&) {
    }
  }
  return std::nullopt;
}

}  // namespace mjdiag
