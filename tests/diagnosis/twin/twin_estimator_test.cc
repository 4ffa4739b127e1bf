#include "mjdiag/diagnosis/twin/twin_estimator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/twin/uncertain_stage.h"
#include "mjdiag/diagnosis/residuals/cramer_rao.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::ElementsAre;

TwinReading Reading(const test::StageRun& run, Index from = 0) {
  TwinEstimator estimator = test::StageEstimator();
  test::Listen(estimator, run, from);
  estimator.CatchUp();
  return estimator.Read();
}

/// Bound of the stage with these deviations, a tone of unknown phase among the unknowns.
VectorXd Bound(const Vector3d& deviations) {
  std::vector<PerturbedModels> perturbed;
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = kStep * Vector3d::Unit(i);
    perturbed.push_back({"", kStep, test::Stage(test::Moved(deviations - step)),
                         test::Stage(test::Moved(deviations + step))});
  }
  const MatrixXd commands = test::Drive(8000);
  std::vector<MatrixXd> sensitivities =
      OutputSensitivities(perturbed, test::kTiming, commands);
  for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
    MatrixXd wave(2, commands.cols());
    for (Index k = 0; k < wave.cols(); ++k) {
      const double angle = 2.0 * std::numbers::pi * test::kTone *
                           static_cast<double>(k) * test::kTiming.tick();
      wave.col(k) = std::sin(angle + phase) * test::kToneAmplitude;
    }
    sensitivities.push_back(
        OutputResponse(test::Stage(test::Moved(deviations)), test::kTiming, wave));
  }
  return CramerRaoBound(sensitivities, Eigen::Vector2d::Constant(test::kNoise))
      .together;
}

// rms over 60 runs is within 1 +- 4 / sqrt(120) of the standard deviation, and 60
// intervals of 95 % hold the truth 50 times but for a probability of 1e-3.
TEST(TwinEstimator, IsAtTheInformationBoundForSmallAndLargeFaults) {
  constexpr int kRuns = 60;
  for (const Vector3d& truth :
       {Vector3d(1e-3, -1e-3, 1e-4), Vector3d(0.5, -0.2, -0.3)}) {
    const VectorXd bound = Bound(truth);
    Vector3d squares = Vector3d::Zero();
    Eigen::Array3i inside = Eigen::Array3i::Zero();
    for (int i = 0; i < kRuns; ++i) {
      const TwinReading reading =
          Reading(test::RunStage(truth, 0.01, static_cast<std::uint64_t>(i)));
      EXPECT_THAT(reading.named, ElementsAre(true, true, true, true));
      for (int fault = 0; fault < 3; ++fault) {
        const double error = reading.deviation[fault] - truth[fault];
        squares[fault] += error * error / kRuns;
        inside[fault] += std::abs(error) < 1.96 * reading.sd[fault] ? 1 : 0;
      }
    }
    for (int fault = 0; fault < 3; ++fault) {
      EXPECT_LT(std::sqrt(squares[fault]), 1.37 * bound[fault]) << fault;
      EXPECT_GT(inside[fault], 49) << fault;
    }
  }
}

TEST(TwinEstimator, FindsTheMagnitudeOfAToneWhosePhaseNobodyKnows) {
  const TwinReading reading = Reading(test::RunStage(Vector3d::Zero(), 0.05, 1));
  EXPECT_THAT(reading.named, ElementsAre(false, false, false, true));
  EXPECT_NEAR(reading.deviation[3], 0.05, 5.0 * reading.sd[3]);
  EXPECT_LT(reading.sd[3], 1e-4);
}

TEST(TwinEstimator, NamesNothingOnAHealthyMachine) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    EXPECT_THAT(Reading(test::RunStage(Vector3d::Zero(), 0.0, seed)).named,
                ElementsAre(false, false, false, false));
  }
}

TEST(TwinEstimator, NeedsNoStartAtRest) {
  const Vector3d truth(0.3, -0.1, -0.05);
  for (const Index from : {37, 1234}) {
    const TwinReading reading = Reading(test::RunStage(truth, 0.0, 7), from);
    EXPECT_THAT(reading.named, ElementsAre(true, true, true, false)) << from;
    for (int fault = 0; fault < 3; ++fault) {
      EXPECT_NEAR(reading.deviation[fault], truth[fault], 5.0 * reading.sd[fault]);
      EXPECT_LT(reading.sd[fault], 2.0 * Bound(truth)[fault]);
    }
  }
}

TEST(TwinEstimator, SaysAtEveryTickWhatItKnowsSoFar) {
  const Vector3d truth(0.5, -0.2, -0.3);
  const test::StageRun run = test::RunStage(truth, 0.01, 11);
  TwinEstimator estimator = test::StageEstimator();
  Vector3d last = Vector3d::Constant(1e-2);
  for (Index k = 0; k < run.outputs.cols(); ++k) {
    estimator.Add({run.outputs.col(k).data(), 2}, {run.inputs.col(k).data(), 2});
    if (k < 1000 || k % 50 != 0) continue;
    const TwinReading reading = estimator.Read();
    for (int i = 0; i < 3; ++i) {
      // 420 estimates of one run: 6 standard deviations but for a probability of 1e-6.
      ASSERT_NEAR(reading.deviation[i], truth[i], 6.0 * reading.sd[i]) << k;
      // It goes back in between, and does not forget.
      ASSERT_LT(reading.sd[i], 1.1 * last[i]) << k;
      last[i] = reading.sd[i];
    }
  }
}

TEST(TwinEstimator, SaysThatItsTwinDoesNotExplainAnotherMachine) {
  test::StageRun run = test::RunStage(Vector3d::Zero(), 0.0, 1);
  // A force that no unknown is: a quadratic one.
  run.outputs.row(0).array() += 1e-3 * (run.inputs.row(0).array() / 60.0).square();
  EXPECT_GT(Reading(run).nis, 10.0);
  EXPECT_LT(Reading(test::RunStage(Vector3d::Zero(), 0.0, 1)).nis, 2.0);
}

TEST(TwinEstimator, DoesNotAllocateWhileTheMachineRuns) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "malloc belongs to the sanitizer";
  const test::StageRun run = test::RunStage(Vector3d(0.5, 0.0, -0.2), 0.0, 1, 8000);
  for (const Index from : {0, 700}) {
    TwinEstimator estimator = test::StageEstimator();
    EXPECT_EQ(test::CountAllocations([&] { test::Listen(estimator, run, from); }), 0);
    EXPECT_GT(estimator.estimator().returns(), 0) << from;
  }
}

}  // namespace
}  // namespace mjdiag
