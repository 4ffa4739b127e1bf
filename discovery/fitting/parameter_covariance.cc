#include "mjdiag/discovery/fitting/parameter_covariance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ScaledInformation InformationOf(const DiscoveryProblem& problem,
                                const std::vector<Candidate>& candidates,
                                const CauseFit& fit) {
  const Index channels = problem.run().outputs.rows();
  const Index n = problem.train() - problem.skip();
  const MatrixXd J = fit.jacobian.middleRows(channels * problem.skip(), channels * n);
  ScaledInformation information;
  VectorXd known = VectorXd::Ones(J.cols());
  Index i = fit.numbers.size();
  for (const FitParameter& parameter : ParametersOf(candidates, fit.causes)) {
    known[i++] = std::pow(parameter.spread, -2);
  }
  known *= fit.prior_weight;
  // A parameter that does nothing where it is has the scale of what is known of it.
  information.scale = (J.colwise().squaredNorm().transpose() + known)
                          .cwiseMax(1e-300)
                          .cwiseSqrt()
                          .cwiseInverse();
  information.jacobian = J * information.scale.asDiagonal();
  information.known = known.cwiseProduct(information.scale.cwiseAbs2());
  information.matrix = information.jacobian.transpose() * information.jacobian;
  information.matrix.diagonal() += information.known;
  return information;
}

InverseInformation InverseOf(const ScaledInformation& information) {
  constexpr double kNothing = 1e-14;   // of the largest eigenvalue
  constexpr double kTakesPart = 1e-6;  // of a direction, squared
  const auto [values, vectors] = SymmetricEigenDecomposition(information.matrix);
  const Index n = values.size();
  InverseInformation inverse{MatrixXd::Zero(n, n),
                             std::vector<bool>(static_cast<std::size_t>(n), true)};
  for (Index d = 0; d < n; ++d) {
    const VectorXd direction = vectors.col(d);
    if (values[d] > kNothing * values[n - 1]) {
      inverse.matrix += direction * direction.transpose() / values[d];
      continue;
    }
    for (Index i = 0; i < n; ++i) {
      if (direction[i] * direction[i] > kTakesPart) {
        inverse.told[static_cast<std::size_t>(i)] = false;
      }
    }
  }
  for (Index i = 0; i < n; ++i) {
    if (inverse.told[static_cast<std::size_t>(i)]) continue;
    inverse.matrix.row(i).setZero();
    inverse.matrix.col(i).setZero();
  }
  return inverse;
}

MatrixXd ParameterCovariance(const DiscoveryProblem& problem,
                             const std::vector<Candidate>& candidates,
                             const CauseFit& fit) {
  const Index channels = problem.run().outputs.rows();
  const Index parameters = fit.jacobian.cols();
  const Index n = problem.train() - problem.skip();
  const ScaledInformation information = InformationOf(problem, candidates, fit);
  const VectorXd& scale = information.scale;
  const MatrixXd& scaled = information.jacobian;
  const VectorXd e = fit.residual.segment(channels * problem.skip(), channels * n);
  MatrixXd scores(n, parameters);
  for (Index k = 0; k < n; ++k) {
    scores.row(k) = e.segment(channels * k, channels).transpose() *
                    scaled.middleRows(channels * k, channels);
  }
  // The colour of the innovations reaches over the memory of the observer; more than a
  // twentieth of the record would be noise itself.
  const auto lags = static_cast<Index>(std::min(
      0.05 * static_cast<double>(n), 50.0 + std::sqrt(static_cast<double>(n))));
  MatrixXd B = scores.transpose() * scores;
  for (Index lag = 1; lag <= lags; ++lag) {
    const MatrixXd product =
        scores.topRows(n - lag).transpose() * scores.bottomRows(n - lag);
    const double weight =
        1.0 - static_cast<double>(lag) / (static_cast<double>(lags) + 1.0);
    B += weight * (product + product.transpose());
  }
  // What is known beforehand: independent measurements.
  B.diagonal() += fit.prior_weight * information.known;
  const auto [inverse, told] = InverseOf(information);
  MatrixXd covariance =
      scale.asDiagonal() * (inverse * B * inverse) * scale.asDiagonal();
  for (Index i = 0; i < parameters; ++i) {
    if (told[static_cast<std::size_t>(i)]) continue;
    covariance(i, i) = std::numeric_limits<double>::infinity();
  }
  return covariance;
}

}  // namespace mjdiag
