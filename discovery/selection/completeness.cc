#include "mjdiag/discovery/selection/completeness.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/replay/observer.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kLags = 40;

/// p of the colour of e beside that of noise.
double ColourValue(const VectorXd& e, const VectorXd& noise) {
  const auto n = static_cast<double>(e.size());
  const double square = e.squaredNorm();
  if (!(square > 0.0)) return 1.0;
  double Q = 0.0;
  for (Index l = 1; l <= noise.size(); ++l) {
    const double r = e.head(e.size() - l).dot(e.tail(e.size() - l)) / square;
    Q += n * std::pow(r - noise[l - 1], 2);
  }
  return ChiSquaredExceedance(Q, static_cast<double>(noise.size()));
}

/// p of what is larger than it should be.
double SizeValue(const VectorXd& unseen, const VectorXd& fitted) {
  const auto n = static_cast<double>(unseen.size());
  const auto m = static_cast<double>(fitted.size());
  return FExceedance(unseen.squaredNorm() / n / (fitted.squaredNorm() / m), n, m);
}

/// Whether noise is more than the steps of the readings.
bool IsFine(const SensorSetup& sensor, double noise_sd) {
  return sensor.resolution <= 2.0 * noise_sd;
}

}  // namespace

double NoiseValue(const DiscoveryProblem& problem, const VectorXd& innovations,
                  const VectorXd& unseen) {
  const Observer& observer = problem.observer();
  const Index channels = problem.run().outputs.rows();
  const Index n = problem.train() - problem.skip();
  const Index lags = std::min(kLags, n / 10);
  const auto by_channel = [&](const VectorXd& all) {
    return Eigen::Map<const MatrixXd>(all.data(), channels, all.size() / channels);
  };
  std::vector<double> values;
  for (Index c = 0; c < channels; ++c) {
    const auto& sensor =
        problem.machine().channels().sensors[static_cast<std::size_t>(c)];
    if (lags == 0 || !IsFine(sensor, observer.noise_sd[c])) continue;
    const VectorXd all = by_channel(innovations).row(c);
    const VectorXd fitted = all.segment(problem.skip(), n);
    values.push_back(ColourValue(fitted, NoiseCorrelation(observer, c, lags)));
    const Index held_out = all.size() - problem.train();
    if (held_out > 0) values.push_back(SizeValue(all.tail(held_out), fitted));
    const Index others = unseen.size() / channels - problem.skip();
    if (others <= 0) continue;
    values.push_back(SizeValue(by_channel(unseen).row(c).tail(others), fitted));
  }
  if (values.empty()) return 1.0;
  return std::min(1.0, std::ranges::min(values) * static_cast<double>(values.size()));
}

double ProbabilityOfNoise(double p) {
  constexpr double kBefore = 0.95;  // P_0
  constexpr double e = std::numbers::e;
  const double B = p <= 0.0 ? 0.0 : p < 1.0 / e ? -e * p * std::log(p) : 1.0;
  return B / (B + (1.0 - kBefore) / kBefore);
}

bool IsComplete(double complete) { return complete >= 0.5; }

double AmongAllLaws(double named, double complete) {
  constexpr double kRightAllTheSame = 0.15;
  return named * (complete + (1.0 - complete) * kRightAllTheSame);
}

}  // namespace mjdiag
