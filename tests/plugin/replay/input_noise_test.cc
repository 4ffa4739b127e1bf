#include "mjdiag/plugin/replay/input_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

MeasuredRun TwoRecords(Index samples) {
  MeasuredRun run;
  run.sample_time = 1e-3;
  run.outputs = Eigen::MatrixXd::Zero(1, 2 * samples);
  run.inputs = Eigen::MatrixXd::Zero(2, 2 * samples);
  run.records = {{}, {}};
  run.records[1].sample = samples;
  return run;
}

TEST(InputNoise, FallsAsAGaussianWindowHasIt) {
  constexpr Index kSamples = 20000;
  constexpr double kWidth = 4.0;
  const MeasuredRun run = TwoRecords(kSamples);
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  const VectorXd noise =
      VectorXd::NullaryExpr(2 * kSamples, [&] { return normal(generator); });
  const double variance = Smoothed(noise, run, kWidth).squaredNorm() / (2.0 * kSamples);
  const double expected = 1.0 / (2.0 * std::sqrt(std::numbers::pi) * kWidth);
  // Some 2 n / 14 independent values: 1.9 % is a standard deviation; five of them.
  EXPECT_NEAR(variance / expected, 1.0, 0.1);
}

TEST(InputNoise, IsOfEveryRecordByItself) {
  constexpr Index kSamples = 50;
  MeasuredRun run = TwoRecords(kSamples);
  run.inputs.row(0).head(kSamples).setConstant(2.0);
  run.inputs.row(0).tail(kSamples).setConstant(-1.0);
  run.inputs(1, 10) = 1.0;
  const MeasuredRun smooth = WithSmoothedInputs(run, Eigen::Vector2d(8.0, 0.0));
  EXPECT_TRUE(smooth.inputs.isApprox(run.inputs, 1e-12));
}

/// Of 4000 samples.
VectorXd SignalOf(const std::function<double(Index)>& value) {
  return VectorXd::NullaryExpr(4000, value);
}

TEST(InputNoise, IsWhatScattersFromSampleToSample) {
  const MeasuredRun run = TwoRecords(2000);
  std::mt19937 generator(2);
  std::normal_distribution<double> normal;
  const auto slow = [](Index k) { return std::sin(1e-3 * static_cast<double>(k)); };
  EXPECT_TRUE(IsNoiseWithin(
      SignalOf([&](Index k) { return slow(k) + 0.02 * normal(generator); }), run, 2.0));
}

// What a relay, or a sine, asks of a drive is no noise, however much smoothing takes of it.
TEST(InputNoise, IsNotWhatACommandHasOfEdgesAndCurvature) {
  const MeasuredRun run = TwoRecords(2000);
  EXPECT_FALSE(IsNoiseWithin(
      SignalOf([](Index k) { return k / 30 % 2 == 0 ? 4.0 : -4.0; }), run, 2.0));
  EXPECT_FALSE(IsNoiseWithin(
      SignalOf([](Index k) { return std::sin(0.05 * static_cast<double>(k)); }), run,
      2.0));
}

}  // namespace
}  // namespace mjdiag
