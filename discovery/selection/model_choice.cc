#include "mjdiag/discovery/selection/model_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/comparison/noise_floor.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double Deviance(const VectorXd& residual, const VectorXd& independent, Index first,
                Index last) {
  const Index channels = independent.size();
  const Eigen::Map<const MatrixXd> e(residual.data(), channels,
                                     residual.size() / channels);
  double deviance = 0.0;
  for (Index c = 0; c < channels; ++c) {
    const double n = independent[c] * static_cast<double>(last - first);
    const double square = e.row(c).segment(first, last - first).squaredNorm() /
                          static_cast<double>(last - first);
    const double scale = std::max(1.0, square);
    deviance += n * (std::log(scale) + square / scale);
  }
  return deviance;
}

VectorXd IndependentShare(const DiscoveryProblem& problem, const VectorXd& residual) {
  const Index channels = problem.run.outputs.rows();
  const Index n = problem.train - problem.skip;
  const Eigen::Map<const MatrixXd> e(residual.data(), channels,
                                     residual.size() / channels);
  VectorXd share(channels);
  for (Index c = 0; c < channels; ++c) {
    const VectorXd signal = e.row(c).segment(problem.skip, n);
    const Spectrum spectrum = PowerSpectrum(signal, problem.run.sample_time);
    share[c] = std::min(1.0, IndependentSamples(spectrum, n) / static_cast<double>(n));
  }
  return share;
}

// Upper tail of chi-squared with 1 to 3 degrees of freedom by exp(-x/2) (x/2)^(f/2 - 1)
// / gamma(f / 2), exact for 2; solved for x by iteration.
double GainByChance(double probability, int trials, int freedom) {
  const double target =
      std::log(static_cast<double>(std::max(trials, 1)) / probability);
  const double power = 0.5 * freedom - 1.0;
  double half = target;
  for (int i = 0; i < 20; ++i) {
    half = target + power * std::log(half) - std::lgamma(0.5 * freedom);
  }
  return 2.0 * half;
}

int ParameterCount(const std::vector<FittedCause>& causes) {
  int count = 0;
  for (const FittedCause& cause : causes) count += static_cast<int>(cause.value.size());
  return count;
}

double Criterion(const DiscoveryProblem& problem, const CauseFit& fit,
                 const VectorXd& independent) {
  const double samples = static_cast<double>(problem.train - problem.skip);
  const double n = std::max(2.0, samples * independent.sum());
  return Deviance(fit.residual, independent, problem.skip, problem.train) +
         ParameterCount(fit.causes) * std::log(n);
}

std::vector<double> Criteria(const DiscoveryProblem& problem,
                             const std::vector<std::optional<CauseFit>>& fits) {
  const CauseFit* best = nullptr;
  for (const auto& fit : fits) {
    if (fit && (best == nullptr || fit->train < best->train)) best = &*fit;
  }
  std::vector<double> criteria(fits.size(), std::numeric_limits<double>::infinity());
  if (best == nullptr) return criteria;
  const VectorXd independent = IndependentShare(problem, best->residual);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i]) criteria[i] = Criterion(problem, *fits[i], independent);
  }
  return criteria;
}

}  // namespace mjdiag
