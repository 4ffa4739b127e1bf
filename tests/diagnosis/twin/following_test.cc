// What a twin does when the readings that it keeps do not reach back to the start any
// more: here after half a second.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/twin/uncertain_stage.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using testing::Each;
using testing::ElementsAre;

constexpr Index kKept = 4096;
constexpr Index kGain = 2;  // of the faults

/// Readings of a stage whose motor is 1 + gain(tick) times as strong as it should be.
template <typename Gain>
test::StageRun RunWithMotor(const Gain& gain, std::uint64_t seed, Index samples) {
  const StateSpace tick =
      TickModel(test::Stage(), test::kTiming.step, test::kTiming.substeps);
  test::StageRun run;
  run.inputs = test::Drive(samples);
  run.outputs = test::WhiteNoise(2, samples, test::kNoise, seed);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(tick.A.rows());
  for (Index k = 0; k < samples; ++k) {
    run.outputs.col(k) += tick.C * x + test::UncertainStage().rest;
    Eigen::Vector2d force = run.inputs.col(k);
    force[0] *= 1.0 + gain(k);
    x = (tick.A * x + tick.B * force).eval();
  }
  return run;
}

PredictionErrorOptions ShortMemory() {
  PredictionErrorOptions options;
  options.kept = kKept;
  return options;
}

/// Looks after every block from the tick on at which it follows.
template <typename Look>
void Follow(TwinEstimator& estimator, const test::StageRun& run, const Look& look) {
  for (Index k = 0; k < run.outputs.cols(); ++k) {
    estimator.Add({run.outputs.col(k).data(), 2}, {run.inputs.col(k).data(), 2});
    if (estimator.estimator().following() && k % test::kBlock == 0) look(k);
  }
}

// 2500 looks at three faults, of which about fifty are independent (a walk of 64 blocks
// apart): an rms of the errors within 1.5 of their standard deviation but for less than
// a probability of 1e-6.
TEST(Following, KeepsItsIntervalsAndNamesNothingOnAHealthyMachine) {
  const test::StageRun run = RunWithMotor([](Index) { return 0.0; }, 1, 24000);
  TwinEstimator estimator = test::StageEstimator(ShortMemory());
  Vector3d squares = Vector3d::Zero();
  int looks = 0;
  Follow(estimator, run, [&](Index k) {
    const TwinReading reading = estimator.Read();
    ASSERT_THAT(reading.named, Each(false)) << k;
    ASSERT_LT(reading.nis, 2.0) << k;
    for (int i = 0; i < 3; ++i) {
      squares[i] += std::pow(reading.deviation[i] / reading.sd[i], 2);
    }
    ++looks;
  });
  EXPECT_GT(looks, 2000);
  for (const double sum : squares) EXPECT_LT(std::sqrt(sum / looks), 1.5);
  EXPECT_EQ(estimator.estimator().since(), 0);
}

TEST(Following, KeepsItsIntervalsOfAFaultThatGrowsByAPercentAnHour) {
  const auto gain = [](Index k) {
    return 0.01 / 3600.0 * static_cast<double>(k) * test::kTiming.tick();
  };
  const test::StageRun run = RunWithMotor(gain, 2, 24000);
  TwinEstimator estimator = test::StageEstimator(ShortMemory());
  double squares = 0.0;
  int looks = 0;
  Follow(estimator, run, [&](Index k) {
    const TwinReading reading = estimator.Read();
    squares += std::pow((reading.deviation[kGain] - gain(k)) / reading.sd[kGain], 2);
    ++looks;
  });
  EXPECT_LT(std::sqrt(squares / looks), 1.5);
}

// A percent an hour is many standard deviations of a constant fault before the first
// readings are forgotten; what is named beside it is not there.
TEST(Following, NamesNothingBesideAFaultThatGrowsFromTheStart) {
  const auto gain = [](Index k) {
    return 0.01 / 3600.0 * static_cast<double>(k) * test::kTiming.tick();
  };
  const test::StageRun run = RunWithMotor(gain, 5, 24000);
  TwinEstimator estimator = test::StageEstimator({});
  for (Index k = 0; k < run.outputs.cols(); ++k) {
    estimator.Add({run.outputs.col(k).data(), 2}, {run.inputs.col(k).data(), 2});
    if (k % 400 != 399 || !estimator.estimator().began()) continue;
    const std::vector<bool> named = estimator.Read().named;
    EXPECT_FALSE(named[0] || named[1] || named[3]) << k;
  }
  EXPECT_EQ(estimator.estimator().since(), 0);
}

TEST(Following, NoticesAChange) {
  constexpr Index kChange = 16000;
  const test::StageRun run =
      RunWithMotor([](Index k) { return k < kChange ? 0.0 : -0.05; }, 3, 24000);
  TwinEstimator estimator = test::StageEstimator(ShortMemory());
  test::Listen(estimator, run);
  const TwinReading reading = estimator.Read();
  EXPECT_NEAR(static_cast<double>(estimator.estimator().since()), kChange, 64.0);
  EXPECT_THAT(reading.named, ElementsAre(false, false, true, false));
  EXPECT_NEAR(reading.deviation[kGain], -0.05, 5.0 * reading.sd[kGain]);
}

TEST(Following, NeedsNoMemoryButThatOfItsStart) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "malloc belongs to the sanitizer";
  const test::StageRun run = RunWithMotor([](Index) { return 0.0; }, 4, 16000);
  TwinEstimator estimator = test::StageEstimator(ShortMemory());
  EXPECT_EQ(test::CountAllocations([&] { test::Listen(estimator, run); }), 0);
  EXPECT_TRUE(estimator.estimator().following());
}

}  // namespace
}  // namespace mjdiag
