#include "mjdiag/discovery/fitting/parameter_covariance.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

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
  information.scale = J.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  information.jacobian = J * information.scale.asDiagonal();
  information.known = VectorXd::Ones(J.cols());
  Index i = fit.numbers.size();
  for (const FitParameter& parameter : ParametersOf(candidates, fit.causes)) {
    information.known[i++] = std::pow(parameter.spread, -2);
  }
  information.known =
      fit.prior_weight * information.known.cwiseProduct(information.scale.cwiseAbs2());
  information.matrix = information.jacobian.transpose() * information.jacobian;
  information.matrix.diagonal() += information.known;
  return information;
}

MatrixXd ParameterCovariance(const DiscoveryProblem& problem,
                             const std::vector<Candidate>& candidates,
                             const CauseFit& fit) {
  const Index channels = problem.run().outputs.rows();
  const Index parameters = fit.jacobian.cols();
  const Index n = problem.train() - problem.skip();
  const auto [scaled, scale, known, all] = InformationOf(problem, candidates, fit);
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
  B.diagonal() += fit.prior_weight * known;
  const Eigen::FullPivLU<MatrixXd> information(all);
  if (!information.isInvertible()) {
    return MatrixXd::Identity(parameters, parameters) *
           std::numeric_limits<double>::infinity();
  }
  const MatrixXd inverse = information.inverse();
  return scale.asDiagonal() * (inverse * B * inverse) * scale.asDiagonal();
}

}  // namespace mjdiag
