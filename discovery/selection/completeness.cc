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

/// Whether what is left of a sensor, or its noise, is more than the steps of its readings.
bool IsFine(const SensorSetup& sensor, double noise_sd, double left) {
  return sensor.resolution <= 2.0 * std::max(noise_sd, left);
}

}  // namespace

double NoiseValue(const DiscoveryProblem& problem, const VectorXd& innovations,
                  const VectorXd& unseen, const Eigen::ArrayXX<bool>& measured) {
  const Observer& observer = problem.observer();
  const Index channels = problem.run().outputs.rows();
  const Index samples = problem.run().samples();
  std::vector<double> values;
  for (Index c = 0; c < channels; ++c) {
    const auto& sensor =
        problem.machine().channels().sensors[static_cast<std::size_t>(c)];
    const VectorXd fitted =
        problem.MeasuredOf(innovations, c, problem.skip(), problem.train());
    const Index lags = std::min(kLags, fitted.size() / 10);
    if (lags == 0) continue;
    const double left =
        observer.innovation_sd[c] *
        std::sqrt(fitted.squaredNorm() / static_cast<double>(fitted.size()));
    if (!IsFine(sensor, observer.noise_sd[c], left)) continue;
    // A slow sensor has only every so many of them.
    const Index period = problem.run().PeriodOf(c);
    const VectorXd noise = NoiseCorrelation(observer, c, period * lags);
    values.push_back(ColourValue(fitted, VectorXd::NullaryExpr(lags, [&](Index l) {
                                   return noise[period * (l + 1) - 1];
                                 })));
    const VectorXd held_out =
        problem.MeasuredOf(innovations, c, problem.train(), samples);
    if (held_out.size() > 0) values.push_back(SizeValue(held_out, fitted));
    const Index others = unseen.size() / channels - problem.skip();
    if (others <= 0) continue;
    const Eigen::Map<const MatrixXd> of_others(unseen.data(), channels,
                                               unseen.size() / channels);
    VectorXd other = of_others.row(c).tail(others);
    if (measured.size() > 0) {
      other = Kept(other, measured.row(c).tail(others).transpose());
    }
    values.push_back(SizeValue(other, fitted));
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
