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
  const double rest = MeanSquare(problem, residual, problem.skip(), problem.train());
  return kByChance * std::max(1.0, rest) /
         IndependentShare(problem, residual).minCoeff();
}

/// What the innovations of the coarse problem are off by; none where it cannot be run.
/// @param exact  innovations of the problem itself
std::optional<VectorXd> OffBy(const VectorXd& exact, const DiscoveryProblem& coarse,
                              const Changes& changes) {
  try {
    return exact - coarse.Residual(changes);
  } catch (const NumericalError&) {
    return std::nullopt;
  }
}

}  // namespace

bool IsNear(const DiscoveryProblem& coarse, const DiscoveryProblem& problem,
            const Changes& changes) {
  const VectorXd exact = problem.Residual(changes);
  const auto off = OffBy(exact, coarse, changes);
  return off && off->squaredNorm() < Insignificant(problem, exact);
}

std::optional<DiscoveryProblem> Coarsen(const DiscoveryProblem& problem,
                                        const Changes& changes) {
  const int substeps = problem.machine().rates().substeps;
  if (substeps < 2) return std::nullopt;
  constexpr double kOfNoise = 100.0;
  constexpr double kOfRest = 0.1;
  const VectorXd exact = problem.Residual(changes);
  const double near = Insignificant(problem, exact);
  const double most = std::max(kOfNoise * near, kOfRest * exact.squaredNorm());
  std::optional<DiscoveryProblem> shifted;
  for (int fewer = 1; fewer < std::min(substeps, 3); ++fewer) {
    const DiscoveryProblem coarse = problem.WithSubsteps(fewer);
    const auto off = OffBy(exact, coarse, changes);
    if (!off) continue;
    if (off->squaredNorm() < near) return coarse;
    const bool may_be_shifted = !problem.numbers().empty() && off->squaredNorm() < most;
    if (!shifted && may_be_shifted) shifted = coarse.Shifted(*off);
  }
  return shifted;
}

}  // namespace mjdiag
