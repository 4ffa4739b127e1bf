#include "mjdiag/diagnosis/monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/test_design.h"
#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/diagnosis/diagnosis_result.h"
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

DiagnosisRecording Recorded(const MatrixXd& signals, const MatrixXd& baseline = {}) {
  return RecordDiagnosis(Design(), RecordOf(signals), baseline);
}

DiagnosisMonitor Diagnosed(const MatrixXd& signals, const MatrixXd& baseline = {}) {
  DiagnosisMonitor monitor(Design(), baseline);
  mjdiag::Run(monitor, RecordOf(signals));
  return monitor;
}

/// One tick with the readings and commands of a column of z.
template <typename Watcher>
void AddTick(Watcher& watcher, const VectorXd& z) {
  const Vector2d y = z.head(2) + Design().offset;
  const Vector2d u = z.tail(2);
  watcher.Add({y.data(), 2}, {u.data(), 2});
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

TEST(DiagnosisMonitor, GivesTheSameBitsTickByTickAndOverARecord) {
  const MatrixXd signals = test::Measured(
      test::Motion(test::Stage({.damping = 1.01}), test::Drive(kSamples)), 1);
  const DiagnosisRecording offline = Recorded(signals);
  const Record record = RecordOf(signals);
  DiagnosisRecording online(Design(), kSamples);
  for (Index k = 0; k < kSamples; ++k) {
    const std::vector<double> y{record.At("stage").samples[k],
                                record.At("load").samples[k]};
    const std::vector<double> u{signals(2, k), signals(3, k)};
    online.Add(y, u);
  }
  const MonitorLog one = offline.recorder.Log();
  const MonitorLog other = online.recorder.Log();
  EXPECT_EQ(offline.recorder.Residuals(), online.recorder.Residuals());
  EXPECT_EQ(one.residual, other.residual);
  EXPECT_EQ(one.integral, other.integral);
  EXPECT_EQ(one.disturbance, other.disturbance);
  EXPECT_EQ(one.estimates, other.estimates);
  EXPECT_EQ(offline.monitor.estimator().Estimate().covariance,
            online.monitor.estimator().Estimate().covariance);
  EXPECT_EQ(offline.monitor.first_detection(), online.monitor.first_detection());
}

// What bridges a gap is no reading: nothing is judged before the filters forget it.
TEST(DiagnosisMonitor, JudgesNothingInGaps) {
  const MatrixXd signals =
      test::Measured(test::Motion(test::Stage(), test::Drive(kSamples)), 1);
  SampleMask measured = SampleMask::Constant(kSamples, true);
  measured.segment(1500, 60) = false;
  const auto first_detection = [&](const SampleMask& of_stage) {
    const Record whole = RecordOf(signals);
    Record held(whole.sample_time());
    for (Channel channel : whole.channels()) {
      if (channel.name == "stage") {
        channel.samples.segment(1500, 60).setConstant(channel.samples[1499]);
        channel.measured = of_stage;
      }
      held.Add(channel);
    }
    return RecordDiagnosis(Design(), held).monitor.first_detection();
  };
  EXPECT_TRUE(first_detection({}).has_value());
  EXPECT_FALSE(first_detection(measured).has_value());
}

TEST(DiagnosisMonitor, GivesTheSameBitsWithoutARecorder) {
  const MatrixXd signals = test::Measured(
      test::Motion(test::Stage({.damping = 1.01}), test::Drive(kSamples)), 1);
  const DiagnosisMonitor alone = Diagnosed(signals);
  const DiagnosisMonitor recorded = Recorded(signals).monitor;
  EXPECT_EQ(alone.residuals(), recorded.residuals());
  EXPECT_EQ(alone.estimate(), recorded.estimate());
  EXPECT_EQ(alone.first_detection(), recorded.first_detection());
  EXPECT_EQ(alone.first_lasting(), recorded.first_lasting());
}

TEST(DiagnosisMonitor, SaysBetweenTicksWhatItKnows) {
  // The fault comes in the middle and goes: the alarm does, too, its first moment
  // stays.
  constexpr Index kOnset = 1500;
  constexpr Index kEnd = 2500;
  VectorXd extra = VectorXd::Zero(kSamples);
  extra.segment(kOnset, kEnd - kOnset) =
      -0.1 * test::Drive(kSamples).row(0).segment(kOnset, kEnd - kOnset).transpose();
  const MatrixXd signals = MotionWithExtraForce(extra);
  const MatrixXd expected =
      FilterSignals(Design().bank.filters, signals).topRows(test::kRelations);
  DiagnosisMonitor monitor(Design());
  Index alarms = 0;
  for (Index k = 0; k < kSamples; ++k) {
    AddTick(monitor, signals.col(k));
    ASSERT_EQ(monitor.samples(), k + 1);
    ASSERT_LT((monitor.residuals() - expected.col(k)).cwiseAbs().maxCoeff(), 1e-6);
    ASSERT_EQ(monitor.residual_alarm(), std::abs(monitor.residuals()[0]) >= 6.0);
    ASSERT_EQ(monitor.lasting_alarm(), monitor.integral() > 2.0);
    ASSERT_EQ(monitor.regressed(), k % Design().decimation == 0);
    if (monitor.residual_alarm() && alarms++ == 0) {
      EXPECT_EQ(monitor.first_detection(), k);
    }
    ASSERT_EQ(monitor.first_detection().has_value(), alarms > 0);
  }
  EXPECT_GT(alarms, 0);
  EXPECT_FALSE(monitor.residual_alarm());
  EXPECT_TRUE(monitor.first_detection().has_value());
}

TEST(DiagnosisMonitor, RaisesNoAlarmWithoutLimits) {
  DiagnosisDesign design = Design();
  design.limits.known = false;
  DiagnosisMonitor monitor(design);
  for (Index k = 0; k < 1000; ++k)
    AddTick(monitor, VectorXd::Constant(4, 1e-3 * static_cast<double>(k)));
  EXPECT_GT(std::abs(monitor.residuals()[0]), 6.0);
  EXPECT_FALSE(monitor.residual_alarm());
  EXPECT_EQ(monitor.first_detection(), std::nullopt);
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
  const DiagnosisRecording first = Recorded(motion);
  EXPECT_TRUE(first.monitor.first_detection().has_value());
  const MatrixXd baseline = first.recorder.Residuals();
  EXPECT_TRUE(Recorded(motion, baseline).recorder.Residuals().isZero(0.0));
  EXPECT_EQ(Diagnosed(test::Measured(motion, 5), baseline).first_detection(),
            std::nullopt);
}

TEST(DiagnosisMonitor, RefusesABaselineOfOtherResiduals) {
  EXPECT_THROW(DiagnosisMonitor(Design(), MatrixXd::Zero(1, 10)), InputError);
}

TEST(DiagnosisMonitor, RunsOnBeyondItsBaseline) {
  const MatrixXd signals = test::Motion(test::Stage(), test::Drive(100));
  const DiagnosisMonitor monitor =
      Diagnosed(signals, MatrixXd::Constant(test::kRelations, 99, 1e3));
  EXPECT_EQ(monitor.samples(), 100);
  EXPECT_LT(monitor.residuals().cwiseAbs().maxCoeff(), 1.0);
}

TEST(DiagnosisMonitor, RaisesNoAlarmOnAStartAwayFromRest) {
  // Stage and load rest 5 mm from where the readings are zero.
  const MatrixXd commands = test::Drive(kSamples);
  MatrixXd signals = test::Motion(test::Stage(), commands);
  signals.topRows(2).array() += 5e-3;
  const DiagnosisRecording recording = Recorded(test::Measured(signals, 6));
  EXPECT_EQ(recording.monitor.first_detection(), std::nullopt);
  EXPECT_EQ(recording.monitor.first_lasting(), std::nullopt);
  EXPECT_GT(recording.recorder.Log().estimate_time[0], 0.0);
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
}

TEST(DiagnosisMonitor, NamesItsFaultsAtAnyTick) {
  const MatrixXd signals = test::Measured(
      test::Motion(test::Stage({.damping = 1.01}), test::Drive(kSamples)), 8);
  DiagnosisMonitor monitor(Design());
  const std::vector<std::string> names = Design().FaultNames();
  const auto named = [&] {
    std::vector<std::string> all;
    for (const FaultVerdict& fault : JudgeFaults(monitor)) {
      if (fault.detected) all.push_back(fault.name);
    }
    return all;
  };
  EXPECT_EQ(JudgeFaults(monitor).size(), names.size());
  EXPECT_THAT(named(), testing::IsEmpty());
  for (Index k = 0; k < kSamples; ++k) AddTick(monitor, signals.col(k));
  EXPECT_THAT(named(), testing::ElementsAre("damping"));
}

TEST(DiagnosisMonitor, RegressesFromTheGivenSample) {
  const MatrixXd signals = test::Motion(test::Stage(), test::Drive(1000));
  const DiagnosisRecording recording =
      RecordDiagnosis(Design(), RecordOf(signals), {}, 601);
  EXPECT_EQ(recording.monitor.estimator().samples(), 99);
  EXPECT_DOUBLE_EQ(recording.recorder.Log().estimate_time[0], 604 / 8000.0);
  EXPECT_EQ(recording.recorder.Log().residual.size(), 1000);
}

TEST(DiagnosisMonitor, NamesFaultParametersAndDisturbances) {
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
  DiagnosisMonitor monitor(Design());
  const Record record = RecordOf(MatrixXd::Zero(4, 10), 1e-3);
  EXPECT_EQ(test::MessageOf<InputError>([&] { mjdiag::Run(monitor, record); }),
            "record: sampled every 1.000000 ms; expected the sample time of the "
            "filters, 0.125000 ms");
}

TEST(Run, RefusesARecordWithoutAChannel) {
  DiagnosisMonitor monitor(Design());
  Record record(test::kTiming.tick());
  for (const char* name : {"stage", "load", "motor"}) {
    record.Add({name, "1", VectorXd::Zero(10)});
  }
  const std::string message =
      test::MessageOf<InputError>([&] { mjdiag::Run(monitor, record); });
  EXPECT_NE(message.find("small_motor"), std::string::npos) << message;
  EXPECT_EQ(monitor.samples(), 0);
}

}  // namespace
}  // namespace mjdiag
