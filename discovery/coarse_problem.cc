#include "mjdiag/discovery/coarse_problem.h"

#include <algorithm>
#include <limits>

#include "mjdiag/discovery/model_choice.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// Squared innovations that chance may well explain beside what is left anyway.
double Insignificant(const DiscoveryProblem& problem, const VectorXd& residual) {
  constexpr double kByChance = 20.0;  // of white noise
  const double rest =
      MeanSquare(residual, problem.run.outputs.rows(), problem.skip, problem.train);
  return kByChance * std::max(1.0, rest) /
         IndependentShare(problem, residual).minCoeff();
}

double Difference(const DiscoveryProblem& coarse, const VectorXd& exact,
                  const Changes& changes) {
  try {
    return (coarse.Residual(changes) - exact).squaredNorm();
  } catch (const NumericalError&) {
    return std::numeric_limits<double>::infinity();
  }
}

}  // namespace

std::unique_ptr<CoarseProblem> Coarsen(const DiscoveryProblem& problem,
                                       const Changes& changes) {
  const VectorXd exact = problem.Residual(changes);
  const double most = Insignificant(problem, exact);
  const int substeps = problem.setup->substeps;
  for (int fewer = 1; fewer < std::min(substeps, 3); ++fewer) {
    auto coarse = std::make_unique<CoarseProblem>();
    coarse->setup = *problem.setup;
    coarse->setup.substeps = fewer;
    coarse->plant = CopyModel(*problem.plant);
    coarse->plant->opt.timestep *= static_cast<double>(substeps) / fewer;
    coarse->problem = problem;
    coarse->problem.setup = &coarse->setup;
    coarse->problem.plant = coarse->plant.get();
    if (Difference(coarse->problem, exact, changes) < most) return coarse;
  }
  return nullptr;
}

}  // namespace mjdiag
