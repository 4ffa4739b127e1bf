#include "mjdiag/discovery/selection/model_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/comparison/noise_floor.h"
#include "mjdiag/diagnosis/statistics/distributions.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd CountsOf(const VectorXd& measured, Index channels, Index samples) {
  if (measured.size() > 0) return measured.cwiseMax(1.0);
  return VectorXd::Constant(channels, static_cast<double>(samples));
}

}  // namespace

double Deviance(const VectorXd& residual, const VectorXd& independent, Index first,
                Index last, const VectorXd& measured) {
  const Index channels = independent.size();
  const Eigen::Map<const MatrixXd> e(residual.data(), channels,
                                     residual.size() / channels);
  const VectorXd count = CountsOf(measured, channels, last - first);
  double deviance = 0.0;
  for (Index c = 0; c < channels; ++c) {
    const double n = independent[c] * count[c];
    const double square =
        e.row(c).segment(first, last - first).squaredNorm() / count[c];
    const double scale = std::max(1.0, square);
    deviance += n * (std::log(scale) + square / scale);
  }
  return deviance;
}

VectorXd IndependentShare(const DiscoveryProblem& problem, const VectorXd& residual) {
  const Index channels = problem.run().outputs.rows();
  VectorXd share(channels);
  for (Index c = 0; c < channels; ++c) {
    const VectorXd signal =
        problem.MeasuredOf(residual, c, problem.skip(), problem.train());
    const Index n = signal.size();
    const Spectrum spectrum = PowerSpectrum(signal, problem.run().sample_time);
    share[c] = std::min(1.0, IndependentSamples(spectrum, n) / static_cast<double>(n));
  }
  return share;
}

double Inflation(double train, const VectorXd& independent) {
  return std::max(1.0, train) / std::min(1.0, independent.minCoeff());
}

double GainByChance(double probability, int trials, int freedom) {
  return ChiSquaredQuantile(probability / std::max(trials, 1), freedom);
}

bool IsCredible(const std::vector<Candidate>& candidates, const CauseFit& fit,
                const FittedCause& cause) {
  return !IsAtItsEnd(candidates, cause) &&
         (fit.train <= kFarAboveNoise || IsPlausible(candidates, cause));
}

double Criterion(const CauseFit& fit, const VectorXd& independent, Index first,
                 Index last, const VectorXd& measured) {
  const auto samples = static_cast<double>(last - first);
  const double n = std::max(2.0, measured.size() > 0 ? measured.dot(independent)
                                                     : samples * independent.sum());
  return Deviance(fit.residual, independent, first, last, measured) + fit.prior +
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
    if (!fits[i]) continue;
    criteria[i] = Criterion(*fits[i], independent, problem.skip(), problem.train(),
                            problem.Measured(problem.skip(), problem.train()));
  }
  return criteria;
}

}  // namespace mjdiag
