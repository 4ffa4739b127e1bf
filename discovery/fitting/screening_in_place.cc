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

std::optional<VectorXd> InnovationsWithout(const DiscoveryProblem& problem,
                                           const std::vector<Candidate>& candidates,
                                           const CauseFit& fit,
                                           const std::vector<std::size_t>& places) {
  constexpr double kStep = 1e-3;
  FittedModel more = fit;
  const bool have_sizes = std::ranges::all_of(places, [&](std::size_t i) {
    FittedCause& cause = more.causes[i];
    return Enlarge(candidates[cause.candidate], cause, kStep);
  });
  if (!have_sizes) return std::nullopt;
  const DiscoveryProblem seen = problem.TrainPart();
  const VectorXd left = fit.residual.head(seen.run().outputs.size());
  const VectorXd moved = seen.Residual(ChangesOf(seen, candidates, more));
  return left - (moved - left) / kStep;
}

Screening ScreenInPlace(const DiscoveryProblem& problem,
                        const std::vector<Candidate>& candidates, const CauseFit& fit,
                        const std::vector<std::size_t>& places, int starts_each) {
  const FittedModel rest = ModelWithout(fit, places);
  const Eigen::MatrixXd jacobian = JacobianWithout(fit, places);
  const auto innovations = InnovationsWithout(problem, candidates, fit, places);
  if (!innovations) {
    return ScreenBeside(problem, candidates, rest, jacobian, starts_each);
  }
  const DiscoveryProblem seen = problem.TrainPart();
  const auto run = seen.Linearised(ChangesOf(seen, candidates, fit));
  const auto& [track, dynamics] = *run;
  return Screen(seen, candidates, seen.MotionOf(track), dynamics, *innovations,
                jacobian, rest, starts_each);
}

double LossWithout(const DiscoveryProblem& problem,
                   const std::vector<Candidate>& candidates, const CauseFit& fit,
                   std::size_t i) {
  std::vector<FittedCause> twice = fit.causes;
  if (!Enlarge(candidates[twice[i].candidate], twice[i], 1.0)) return 0.0;
  VectorXd sizes = VectorXd::Zero(fit.jacobian.cols());
  const VectorXd of_causes = Flatten(twice) - Flatten(fit.causes);
  if (sizes.size() != fit.numbers.size() + of_causes.size()) return 0.0;
  const ScaledInformation information = InformationOf(problem, candidates, fit);
  const Eigen::MatrixXd& M = information.matrix;
  sizes.tail(of_causes.size()) = of_causes;
  sizes = sizes.cwiseQuotient(information.scale);
  const VectorXd pull = M * sizes;
  const double alone = sizes.dot(pull);
  const std::vector<Index> others = ColumnsWithout(fit, {i});
  if (others.empty()) return alone;
  const VectorXd taken = pull(others);
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
