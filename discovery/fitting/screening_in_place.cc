#include "mjdiag/discovery/fitting/screening_in_place.h"

#include <Eigen/QR>
#include <algorithm>

#include "mjdiag/discovery/fitting/parameter_covariance.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The cause with all that it does larger by a share; false if it has no size.
bool Enlarge(const Candidate& candidate, FittedCause& cause, double share) {
  bool enlarged = false;
  for (Index i = 0; i < cause.value.size(); ++i) {
    const FitParameter& parameter = candidate.parameters[static_cast<std::size_t>(i)];
    if (IsShape(parameter.role)) continue;
    cause.value[i] += share * (cause.value[i] - parameter.nothing);
    enlarged = true;
  }
  return enlarged;
}

}  // namespace

Screening ScreenInPlace(const DiscoveryProblem& problem,
                        const std::vector<Candidate>& candidates, const CauseFit& fit,
                        const std::vector<std::size_t>& places, int starts_each) {
  constexpr double kStep = 1e-3;
  const FittedModel rest = ModelWithout(fit, places);
  const Eigen::MatrixXd jacobian = JacobianWithout(fit, places);
  FittedModel more = fit;
  const bool have_sizes = std::ranges::all_of(places, [&](std::size_t i) {
    FittedCause& cause = more.causes[i];
    return Enlarge(candidates[cause.candidate], cause, kStep);
  });
  if (!have_sizes) {
    return ScreenBeside(problem, candidates, rest, jacobian, starts_each);
  }
  const DiscoveryProblem seen = problem.TrainPart();
  const VectorXd left = fit.residual.head(seen.run().outputs.size());
  const VectorXd moved = seen.Residual(ChangesOf(seen, candidates, more));
  const auto run = seen.Linearised(ChangesOf(seen, candidates, fit));
  const auto& [track, dynamics] = *run;
  return Screen(seen, candidates, seen.MotionOf(track), dynamics,
                left - (moved - left) / kStep, jacobian, rest, starts_each);
}

double LossWithout(const DiscoveryProblem& problem,
                   const std::vector<Candidate>& candidates, const CauseFit& fit,
                   std::size_t i) {
  FittedCause twice = fit.causes[i];
  if (!Enlarge(candidates[twice.candidate], twice, 1.0)) return 0.0;
  const Index all = fit.numbers.size() + Flatten(fit.causes).size();
  if (fit.jacobian.cols() != all) return 0.0;
  std::vector<Index> own;
  std::vector<Index> others;
  Index first = fit.numbers.size();
  for (std::size_t k = 0; k < i; ++k) first += fit.causes[k].value.size();
  for (Index k = 0; k < all; ++k) {
    (k >= first && k < first + twice.value.size() ? own : others).push_back(k);
  }
  const ScaledInformation information = InformationOf(problem, candidates, fit);
  const Eigen::MatrixXd& M = information.matrix;
  const VectorXd size =
      (twice.value - fit.causes[i].value).cwiseQuotient(information.scale(own));
  const double alone = size.dot(M(own, own) * size);
  if (others.empty()) return alone;
  const VectorXd taken = M(others, own) * size;
  const VectorXd over =
      M(others, others).completeOrthogonalDecomposition().solve(taken);
  return alone - taken.dot(over);
}

double ExplainedBy(const DiscoveryProblem& problem, const CauseFit& fit,
                   const Screening& in_place) {
  return in_place.rest - FittedValues(problem) * fit.train -
         fit.prior_weight * fit.numbers.squaredNorm();
}

}  // namespace mjdiag
