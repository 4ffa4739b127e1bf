#include "mjdiag/discovery/selection/number_fit.h"

#include <utility>

#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/discovery/selection/settled_fit.h"

namespace mjdiag {

CauseFit FitNumbers(const DiscoveryProblem& problem,
                    const std::vector<Candidate>& candidates,
                    const Eigen::VectorXd& start, double share) {
  CauseFit fit =
      FitCauses(problem, candidates, {{}, start}, {.iterations = 0, .jacobian = false});
  if (problem.numbers().empty()) return fit;
  constexpr int kAnew = 4;            // derivatives, for the plant may be far off
  constexpr double kNoiseOnly = 1.2;  // mean square at which noise is all that is left
  constexpr double kSettled = 0.01;   // of the mean square
  constexpr double kStalls = 1e-3;    // of it, in a step: new derivatives do more
  bool moved = false;
  for (int i = 0; i < kAnew && fit.train > kNoiseOnly; ++i) {
    FittedModel from = fit;
    from.prior_weight = Inflation(fit.train, IndependentShare(problem, fit.residual));
    CauseFit next = FitCauses(problem, candidates, from,
                              {.iterations = 10,
                               .tolerance = kStalls,
                               .jacobian = false,
                               .secant = true,
                               .share = share / kAnew});
    const bool settled = fit.train - next.train < kSettled * fit.train;
    fit = std::move(next);
    moved = true;
    if (settled) break;
  }
  return moved ? Settled(problem, candidates, std::move(fit), share) : fit;
}

}  // namespace mjdiag
