#include "mjdiag/diagnosis/monitor_recorder.h"

#include <gtest/gtest.h>

#include "diagnosis/test_design.h"
#include "mjdiag/diagnosis/diagnosis_recording.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;

const DiagnosisDesign& Design() {
  static const DiagnosisDesign design = test::StageDesign();
  return design;
}

MatrixXd Signals(Index samples) {
  return test::Measured(test::Motion(test::Stage({.gain = 1.01}), test::Drive(samples)),
                        1);
}

/// Columns `first` to `first + count` of z.
void Feed(DiagnosisRecording& recording, const MatrixXd& signals, Index first,
          Index count) {
  for (Index k = first; k < first + count; ++k) {
    const Vector2d y = signals.col(k).head(2) + Design().offset;
    const Vector2d u = signals.col(k).tail(2);
    recording.Add({y.data(), 2}, {u.data(), 2});
  }
}

TEST(MonitorRecorder, KeepsTheResidualsOfTheFilters) {
  constexpr Index kSamples = 4000;
  const MatrixXd signals = Signals(kSamples);
  DiagnosisRecording recording(Design(), kSamples);
  Feed(recording, signals, 0, kSamples);
  const MatrixXd residuals = recording.recorder.Residuals();
  const MatrixXd expected =
      FilterSignals(Design().bank.filters, signals).topRows(test::kRelations);
  // The offset was added and taken off again: a rounding of 1e-17 m under 20 nm.
  EXPECT_LT((residuals - expected).cwiseAbs().maxCoeff(), 1e-6);
  const MonitorLog log = recording.recorder.Log();
  EXPECT_EQ(log.residual, residuals.row(0).transpose());
  EXPECT_TRUE(log.signals.isApprox(signals, 1e-12));
  const Index window = 800;
  EXPECT_NEAR(log.integral[kSamples - 1],
              expected.row(0).tail(window).cwiseAbs().mean(), 1e-6);
  EXPECT_NEAR(log.integral[99], expected.row(0).head(100).cwiseAbs().sum() / window,
              1e-6);
}

TEST(MonitorRecorder, KeepsEveryEstimateWithItsTime) {
  DiagnosisRecording recording(Design(), 4000);
  Feed(recording, Signals(4000), 0, 4000);
  const MonitorLog log = recording.recorder.Log();
  ASSERT_EQ(log.estimates.cols(), 4000 / Design().decimation);
  EXPECT_EQ(log.estimates.rightCols(1), recording.monitor.estimate());
  EXPECT_DOUBLE_EQ(log.estimate_time[0], 0.0);
  EXPECT_NEAR(log.estimate_time[999], 999 * 4 / 8000.0, 1e-12);
}

TEST(MonitorRecorder, KeepsNoMoreThanItHasRoomForWhileTheMonitorRunsOn) {
  const MatrixXd signals = Signals(100);
  DiagnosisRecording full(Design(), 40);
  Feed(full, signals, 0, 100);
  DiagnosisRecording whole(Design(), 100);
  Feed(whole, signals, 0, 100);
  EXPECT_EQ(full.monitor.samples(), 100);
  EXPECT_EQ(full.monitor.residuals(), whole.monitor.residuals());
  EXPECT_EQ(full.monitor.estimate(), whole.monitor.estimate());
  EXPECT_EQ(full.recorder.samples(), 40);
  EXPECT_EQ(full.recorder.Residuals(), whole.recorder.Residuals().leftCols(40));
  EXPECT_EQ(full.recorder.Log().residual.size(), 40);
}

// A monitor that has run for long gets a new recorder when something is to be looked
// at.
TEST(MonitorRecorder, BeginsWhereItIsAttached) {
  const MatrixXd signals = Signals(200);
  DiagnosisRecording recording(Design(), 200);
  Feed(recording, signals, 0, 102);
  recording.recorder = MonitorRecorder(Design(), 50);
  EXPECT_EQ(recording.recorder.Log().residual.size(), 0);
  Feed(recording, signals, 102, 98);
  DiagnosisRecording whole(Design(), 200);
  Feed(whole, signals, 0, 200);
  const MonitorLog log = recording.recorder.Log();
  EXPECT_EQ(log.residual, whole.recorder.Log().residual.segment(102, 50));
  // Every fourth tick is regressed: the third of those kept is the 104th.
  EXPECT_DOUBLE_EQ(log.estimate_time[0], 2 / 8000.0);
  EXPECT_EQ(log.estimates.col(0), whole.recorder.Log().estimates.col(26));
}

}  // namespace
}  // namespace mjdiag
