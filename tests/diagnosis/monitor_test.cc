#include "mjdiag/diagnosis/monitor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/test_design.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kSamples = 4000;

/// The design is the same for every test, and not free.
const DiagnosisDesign& Design() {
  static const DiagnosisDesign design = test::StageDesign();
  return design;
}

/// What encoders with their offsets record of z.
Record RecordOf(const MatrixXd& signals, double sample_time = test::kTiming.tick()) {
  Record record(sample_time);
  const DiagnosisDesign& design = Design();
  // In another order than the design's.
  record.Add({"small_motor", "N", signals.row(3)});
  record.Add({"load", "m", signals.row(1).array() + design.offset[1]});
  record.Add({"stage", "m", signals.row(0).array() + design.offset[0]});
  record.Add({"motor", "N", signals.row(2)});
  return record;
}

DiagnosisMonitor Diagnosed(const MatrixXd& signals, const MatrixXd& baseline = {}) {
  DiagnosisMonitor monitor(Design(), signals.cols(), baseline);
  mjdiag::Run(monitor, Design(), RecordOf(signals));
  return monitor;
}

/// A motion with noise, with another machine's share of the motor force from a sample
/// on: `extra` [N] on the motor, unknown to the commands.
MatrixXd MotionWithExtraForce(const VectorXd& extra) {
  MatrixXd commands = test::Drive(extra.size());
  MatrixXd forces = commands;
  forces.row(0) += extra;
  MatrixXd signals = test::Motion(test::Stage(), forces);
  signals.bottomRows(2) = commands;
  return signals;
}

TEST(DiagnosisMonitor, GivesTheSameBitsSampleBySampleAndOverARecord) {
  const MatrixXd signals = test::Measured(
      test::Motion(test::Stage({.damping = 1.01}), test::Drive(kSamples)), 1);
  const DiagnosisMonitor offline = Diagnosed(signals);
  const Record record = RecordOf(signals);
  DiagnosisMonitor online(Design(), kSamples);
  for (Index k = 0; k < kSamples; ++k) {
    const std::vector<double> y{record.At("stage").samples[k],
                                record.At("load").samples[k]};
    const std::vector<double> u{signals(2, k), signals(3, k)};
    online.Add(y, u);
  }
  EXPECT_EQ(offline.ResidualRows(), online.ResidualRows());
  EXPECT_EQ(offline.Log().residual, online.Log().residual);
  EXPECT_EQ(offline.Log().integral, online.Log().integral);
  EXPECT_EQ(offline.Log().disturbance, online.Log().disturbance);
  EXPECT_EQ(offline.Log().estimates, online.Log().estimates);
  EXPECT_EQ(offline.estimator().Estimate().covariance,
            online.estimator().Estimate().covariance);
  EXPECT_EQ(offline.first_detection(), online.first_detection());
}

TEST(DiagnosisMonitor, LogsTheResidualsOfItsFilters) {
  const MatrixXd signals = test::Measured(
      test::Motion(test::Stage({.gain = 1.01}), test::Drive(kSamples)), 1);
  const DiagnosisMonitor monitor = Diagnosed(signals);
  const MatrixXd expected =
      FilterSignals(Design().bank.filters, signals).topRows(test::kRows);
  // The offset was added and taken off again: a rounding of 1e-17 m under 20 nm.
  EXPECT_LT((monitor.ResidualRows() - expected).cwiseAbs().maxCoeff(), 1e-6);
  const MonitorLog log = monitor.Log();
  EXPECT_EQ(log.residual, monitor.ResidualRows().row(0).transpose());
  EXPECT_TRUE(log.signals.isApprox(signals, 1e-12));
  const Index window = 800;
  EXPECT_NEAR(log.integral[kSamples - 1],
              expected.row(0).tail(window).cwiseAbs().mean(), 1e-6);
  EXPECT_NEAR(log.integral[99], expected.row(0).head(100).cwiseAbs().sum() / window,
              1e-6);
}

TEST(DiagnosisMonitor, SeesNothingInNominalMotion) {
  const DiagnosisMonitor monitor =
      Diagnosed(test::Measured(test::Motion(test::Stage(), test::Drive(kSamples)), 2));
  EXPECT_EQ(monitor.first_detection(), std::nullopt);
  EXPECT_EQ(monitor.first_lasting(), std::nullopt);
  EXPECT_EQ(monitor.samples(), kSamples);
}

TEST(DiagnosisMonitor, DetectsASuddenFaultAtTheSampleAtWhichItsLimitsAreLeft) {
  constexpr Index kOnset = 1500;
  VectorXd extra = -0.1 * test::Drive(kSamples).row(0).transpose();
  extra.head(kOnset).setZero();
  const MatrixXd signals = MotionWithExtraForce(extra);
  const VectorXd residual =
      FilterSignals(Design().bank.filters, signals).row(0).transpose();
  Index expected = 0;
  while (std::abs(residual[expected]) < 6.0) ++expected;
  EXPECT_EQ(Diagnosed(signals).first_detection(), expected);
  EXPECT_GT(expected, kOnset);
  EXPECT_LT(expected, kOnset + 160);  // 20 ms, twice the rise time
}

TEST(DiagnosisMonitor, TellsALastingFaultFromAPassingDisturbance) {
  // 0.35 N on the motor, for 4 ms of the window's 100 ms and for good.
  VectorXd passing = VectorXd::Zero(kSamples);
  passing.segment(1500, 32).setConstant(0.35);
  const DiagnosisMonitor hit =
      Diagnosed(test::Measured(MotionWithExtraForce(passing), 3));
  EXPECT_TRUE(hit.first_detection().has_value());
  EXPECT_EQ(hit.first_lasting(), std::nullopt);

  VectorXd lasting = VectorXd::Zero(kSamples);
  lasting.tail(kSamples - 1500).setConstant(0.35);
  const DiagnosisMonitor worn =
      Diagnosed(test::Measured(MotionWithExtraForce(lasting), 3));
  ASSERT_TRUE(worn.first_detection() && worn.first_lasting());
  EXPECT_LT(*worn.first_detection(), *worn.first_lasting());
}

TEST(DiagnosisMonitor, SubtractsTheBaseline) {
  // A machine that its linear model does not quite describe, and its next run.
  const MatrixXd motion =
      test::Motion(test::Stage({.damping = 1.05}), test::Drive(kSamples));
  const DiagnosisMonitor first = Diagnosed(motion);
  EXPECT_TRUE(first.first_detection().has_value());
  const DiagnosisMonitor same = Diagnosed(motion, first.ResidualRows());
  EXPECT_TRUE(same.ResidualRows().isZero(0.0));
  const DiagnosisMonitor next =
      Diagnosed(test::Measured(motion, 5), first.ResidualRows());
  EXPECT_EQ(next.first_detection(), std::nullopt);
}

TEST(DiagnosisMonitor, RefusesABaselineOfOtherResiduals) {
  EXPECT_THROW(DiagnosisMonitor(Design(), 10, MatrixXd::Zero(1, 10)), InputError);
}

TEST(DiagnosisMonitor, RaisesNoAlarmOnAStartAwayFromRest) {
  // Stage and load rest 5 mm from where the readings are zero.
  const MatrixXd commands = test::Drive(kSamples);
  MatrixXd signals = test::Motion(test::Stage(), commands);
  signals.topRows(2).array() += 5e-3;
  const DiagnosisMonitor monitor = Diagnosed(test::Measured(signals, 6));
  EXPECT_EQ(monitor.first_detection(), std::nullopt);
  EXPECT_EQ(monitor.first_lasting(), std::nullopt);
  EXPECT_GT(monitor.Log().estimate_time[0], 0.0);
  // Unsettled filters would see a step of 5 mm.
  EXPECT_GT(FilterSignals(Design().bank.filters, signals).row(0).cwiseAbs().maxCoeff(),
            1e3);
}

TEST(DiagnosisMonitor, EstimatesFaultsAndDisturbanceWithinTheirErrors) {
  // Five standard deviations for each of the four.
  const Vector3d fault(2e-3, -1e-2, 1e-3);
  constexpr double kGamma = 0.1;
  const DiagnosisDesign& design = Design();
  const MatrixXd commands = test::Drive(kSamples);
  MatrixXd forces = commands;
  for (Index k = 0; k < kSamples; ++k) {
    MatrixXd waveform(2, 1);
    Waveforms(design.disturbances, static_cast<double>(k) * design.sample_time(),
              waveform);
    forces.col(k) += kGamma * waveform;
  }
  MatrixXd signals = test::Motion(test::Stage(test::Moved(fault)), forces);
  signals.bottomRows(2) = commands;
  const DiagnosisMonitor monitor = Diagnosed(test::Measured(signals, 7));
  const FaultEstimate estimate = monitor.estimator().Estimate();
  ASSERT_EQ(estimate.value.size(), 4);
  const VectorXd sd = estimate.covariance.diagonal().cwiseSqrt();
  for (Index i = 0; i < 4; ++i) {
    const double expected = i < 3 ? fault[i] : kGamma;
    EXPECT_NEAR(estimate.value[i], expected, 5.0 * sd[i]) << design.FaultNames()[i];
    EXPECT_LT(sd[i], 0.1 * std::abs(expected)) << design.FaultNames()[i];
  }
  EXPECT_TRUE(monitor.estimate().isApprox(estimate.value, 1e-9));
  const MonitorLog log = monitor.Log();
  ASSERT_EQ(log.estimates.cols(), kSamples / design.stride);
  EXPECT_EQ(log.estimates.rightCols(1), monitor.estimate());
  EXPECT_DOUBLE_EQ(log.estimate_time[0], 0.0);
  EXPECT_NEAR(log.estimate_time[999], 999 * 4 / 8000.0, 1e-12);
}

TEST(DiagnosisMonitor, RegressesFromTheSampleThatItIsTold) {
  const MatrixXd signals = test::Motion(test::Stage(), test::Drive(1000));
  DiagnosisMonitor monitor(Design(), 1000);
  monitor.RegressFrom(601);
  mjdiag::Run(monitor, Design(), RecordOf(signals));
  EXPECT_EQ(monitor.estimator().samples(), 99);
  EXPECT_DOUBLE_EQ(monitor.Log().estimate_time[0], 604 / 8000.0);
  EXPECT_EQ(monitor.Log().residual.size(), 1000);
}

TEST(DiagnosisMonitor, KeepsOnlyWhatItsLogHolds) {
  const MatrixXd signals = test::Motion(test::Stage(), test::Drive(100));
  DiagnosisMonitor monitor(Design(), 40);
  mjdiag::Run(monitor, Design(), RecordOf(signals));
  EXPECT_EQ(monitor.samples(), 100);
  EXPECT_EQ(monitor.Log().residual.size(), 40);
  EXPECT_EQ(monitor.ResidualRows().cols(), 40);
}

TEST(DiagnosisMonitor, NamesKnobsAndDisturbances) {
  const std::vector<std::string> expected{"damping", "stiffness", "gain", "gamma"};
  EXPECT_EQ(Design().FaultNames(), expected);
  EXPECT_EQ(Design().faults(), 4);
  EXPECT_EQ(Design().Healthy(2), 1.0);
  EXPECT_EQ(Design().Healthy(3), 0.0);
}

TEST(Waveforms, AreSumsOfSinesOnEveryCommand) {
  MatrixXd waveform(2, 1);
  Waveforms(Design().disturbances, 0.003, waveform);
  const double sum = std::sin(2.0 * std::numbers::pi * 60.0 * 0.003) +
                     std::sin(2.0 * std::numbers::pi * 145.0 * 0.003);
  EXPECT_TRUE(waveform.isApprox(sum * Vector2d(0.5, 0.2), 1e-14));
}

TEST(Run, RefusesARecordOfAnotherRate) {
  DiagnosisMonitor monitor(Design(), 10);
  const Record record = RecordOf(MatrixXd::Zero(4, 10), 1e-3);
  EXPECT_EQ(
      test::MessageOf<InputError>([&] { mjdiag::Run(monitor, Design(), record); }),
      "record: sampled every 1.000000 ms; expected the sample time of the "
      "filters, 0.125000 ms");
}

TEST(Run, RefusesARecordWithoutAChannel) {
  DiagnosisMonitor monitor(Design(), 10);
  Record record(test::kTiming.tick());
  for (const char* name : {"stage", "load", "motor"}) {
    record.Add({name, "1", VectorXd::Zero(10)});
  }
  const std::string message =
      test::MessageOf<InputError>([&] { mjdiag::Run(monitor, Design(), record); });
  EXPECT_NE(message.find("small_motor"), std::string::npos) << message;
  EXPECT_EQ(monitor.samples(), 0);
}

}  // namespace
}  // namespace mjdiag
