// The whole diagnosis of the wire bonder, inside the control callback and over a
// record. Quarter-second motions, in which every axis moves alone and together with
// others.

#include "mjdiag/plugin/design/filter_design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"
#include "support/bonder.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::AllOf;
using testing::HasSubstr;

/// With short motions.
Machine Bonder(const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides = {
      R"(diagnosis.thresholds.trajectories=["x", "y", "z", "xy", "xyz"])",
      "trajectories.multi.duration=0.25"};
  for (const char* name : {"x", "y", "z", "xy", "xyz"}) {
    overrides.push_back("trajectories." + std::string(name) + ".duration=0.05");
  }
  overrides.insert(overrides.end(), more.begin(), more.end());
  return test::Bonder(overrides);
}

struct Bench {
  explicit Bench(const std::vector<std::string>& overrides = {})
      : machine(Bonder(overrides)),
        design(DesignFilters(machine)),
        motion(Follow("multi")) {}

  Excitation Follow(const std::string& trajectory) const {
    return FollowTrajectory(machine.setup(),
                            machine.setup().trajectories.Find(trajectory));
  }

  NominalRuns Nominal(bool linear, int runs = 5) const {
    NominalRuns nominal;
    nominal.linear = linear;
    nominal.runs = runs;
    return nominal;
  }
  void Calibrate(bool linear) {
    design.limits = CalibrateLimits(design, machine, Nominal(linear));
  }
  /// A run of this machine, or of a faulty one, with a monitor in the loop.
  template <typename Watcher>
  Record Watch(Watcher& watcher, const Machine& watched, const RunOptions& options,
               bool linear) const {
    MonitorObserver observer(watcher);
    return RunWith(watched, motion, observer, options, linear);
  }
  DiagnosisMonitor MonitorOf(const std::vector<Fault>& faults, std::uint64_t seed,
                             bool linear) const {
    DiagnosisMonitor monitor(design);
    RunOptions options;
    options.seed = seed;
    Watch(monitor, machine.With({faults, {}}), options, linear);
    return monitor;
  }
  double Estimate(const DiagnosisMonitor& monitor, const std::string& fault) const {
    const std::vector<std::string> names = design.FaultNames();
    return monitor
        .estimate()[std::find(names.begin(), names.end(), fault) - names.begin()];
  }

  Machine machine;
  DiagnosisDesign design;
  Excitation motion;
};

void ExpectSameBits(const DiagnosisRecording& recording,
                    const DiagnosisRecording& offline) {
  const MonitorLog a = recording.recorder.Log();
  const MonitorLog b = offline.recorder.Log();
  const DiagnosisMonitor& one = recording.monitor;
  const DiagnosisMonitor& other = offline.monitor;
  EXPECT_EQ(one.samples(), other.samples());
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.integral, b.integral);
  EXPECT_EQ(a.disturbance, b.disturbance);
  EXPECT_EQ(a.estimate_time, b.estimate_time);
  EXPECT_EQ(a.estimates, b.estimates);
  EXPECT_EQ(one.estimator().Estimate().covariance,
            other.estimator().Estimate().covariance);
  EXPECT_EQ(one.first_detection(), other.first_detection());
  EXPECT_EQ(one.first_lasting(), other.first_lasting());
}

TEST(MonitorObserver, GivesInsideTheCallbackTheBitsOfTheRecord) {
  Bench bench({"diagnosis.thresholds.integral_window=0.02"});
  bench.Calibrate(true);
  DiagnosisRecording inside(bench.design, bench.motion.samples());
  RunOptions options;
  options.disturbances["gamma"] = 0.1;
  const Record record =
      bench.Watch(inside, bench.machine.With({{{"zeta_x", 1.3}}, {}}), options, false);
  ASSERT_EQ(inside.monitor.samples(), 2000);
  ASSERT_TRUE(inside.monitor.first_detection().has_value());
  ASSERT_TRUE(inside.monitor.first_lasting().has_value());
  ASSERT_GT(inside.monitor.estimate().norm(), 0.0);

  ExpectSameBits(inside, RecordDiagnosis(bench.design, record));

  const test::TemporaryFolder folder;
  for (const RecordFormat format : {RecordFormat::kCsv, RecordFormat::kMat5}) {
    WriteRecord(folder / "record", record, format);
    ExpectSameBits(inside,
                   RecordDiagnosis(bench.design, ReadRecord(folder / "record")));
  }
}

TEST(MonitorObserver, LeavesTheRunUnchanged) {
  const Bench bench;
  DiagnosisMonitor monitor(bench.design);
  const Record watched = bench.Watch(monitor, bench.machine, {}, false);
  const Record alone = Simulate(bench.machine, bench.motion, {});
  for (const Channel& channel : alone.channels()) {
    EXPECT_EQ(channel.samples, watched.At(channel.name).samples) << channel.name;
  }
}

// The calibration runs in parallel; here the same runs one after the other.
TEST(CalibrateLimits, GivesInParallelTheBitsOfSerialRuns) {
  const Bench bench;
  const NominalRuns nominal = bench.Nominal(false, 4);
  const DiagnosisLimits limits = CalibrateLimits(bench.design, bench.machine, nominal);

  std::vector<VectorXd> residuals;
  std::vector<VectorXd> disturbances;
  MatrixXd estimates(bench.design.faults(), nominal.runs);
  double integral = 0.0;
  const auto run = [&](const std::string& motion, std::uint64_t seed) {
    const Excitation excitation = bench.Follow(motion);
    DiagnosisRecording recording(bench.design, excitation.samples());
    MonitorObserver observer(recording);
    RunOptions options;
    options.seed = seed;
    options.observer = &observer;
    Simulate(bench.machine, excitation, options);
    const MonitorLog log = recording.recorder.Log();
    residuals.push_back(log.residual);
    integral = std::max(integral, log.integral.maxCoeff());
    disturbances.push_back(log.disturbance);
    return recording.monitor.estimate();
  };
  for (int i = 0; i < nominal.runs; ++i) {
    estimates.col(i) = run("multi", nominal.seed + static_cast<std::uint64_t>(i));
  }
  for (const std::string& name : bench.machine.setup().diagnosis.trajectories) {
    run(name, nominal.seed);
  }
  disturbances.resize(4);

  const ThresholdDesign expected = ThresholdsByMargin(residuals, 2.0);
  EXPECT_EQ(limits.residual.limits.min, expected.limits.min);
  EXPECT_EQ(limits.residual.limits.max, expected.limits.max);
  EXPECT_EQ(limits.residual.fit.mean, expected.fit.mean);
  EXPECT_EQ(limits.residual.fit.sd, expected.fit.sd);
  EXPECT_EQ(limits.residual.histogram.count, expected.histogram.count);
  EXPECT_EQ(limits.integral, 2.0 * integral);
  const DisturbanceThresholds quiet = DesignDisturbanceThresholds(
      disturbances, bench.design.sample_time(), bench.design.options.disturbance);
  EXPECT_EQ(limits.disturbance.peak, quiet.peak);
  EXPECT_EQ(limits.disturbance.total, quiet.total);
  EXPECT_EQ(limits.disturbance.noise_ratio, quiet.noise_ratio);
  EXPECT_EQ(limits.disturbance.broadband, quiet.broadband);
  EXPECT_EQ(limits.disturbance.nominal.density, quiet.nominal.density);
  // The middle of an interval for the next estimate is the mean of those there were.
  ASSERT_EQ(limits.estimates.size(), bench.design.faults());
  for (Index i = 0; i < estimates.rows(); ++i) {
    const Interval& interval = limits.estimates[static_cast<std::size_t>(i)];
    EXPECT_NEAR(0.5 * (interval.min + interval.max), estimates.row(i).mean(),
                1e-12 * (interval.max - interval.min));
    EXPECT_TRUE(interval.Holds(estimates.row(i).minCoeff()));
    EXPECT_TRUE(interval.Holds(estimates.row(i).maxCoeff()));
  }
  EXPECT_TRUE(limits.known);
}

TEST(CalibrateLimits, ReportsItsProgress) {
  const Bench bench;
  NominalRuns nominal = bench.Nominal(true, 3);
  std::vector<double> fractions;
  nominal.progress = [&](double fraction) { fractions.push_back(fraction); };
  CalibrateLimits(bench.design, bench.machine, nominal);
  // Other threads may have done the runs that are not reported, but not all.
  for (const double fraction : fractions) EXPECT_LE(fraction, 1.0);
  EXPECT_LE(fractions.size(), 3);
}

// [AB383], Table 2: its smallest detectable faults on the linear plant.
TEST(Diagnosis, DetectsAndMeasuresTheFaultsOfTable2) {
  Bench bench;
  bench.Calibrate(true);
  const std::vector<Fault> table = {{"zeta_x", 1.005},
                                    {"zeta_y", 1.001},
                                    {"eta_x", 0.995},
                                    {"eta_y", 0.999},
                                    {"eta_z", 0.9999}};
  for (const Fault& fault : table) {
    SCOPED_TRACE(fault.name);
    const DiagnosisMonitor monitor = bench.MonitorOf({fault}, 77, true);
    EXPECT_TRUE(monitor.first_detection().has_value());
    const double deviation = fault.value - 1.0;
    // The standard deviations are at most 0.3 % of these deviations (zeta_x), and the
    // regression is about the healthy machine: half a per cent of fault squared.
    EXPECT_NEAR(bench.Estimate(monitor, fault.name), deviation,
                0.01 * std::abs(deviation));
  }
  const DiagnosisMonitor all = bench.MonitorOf(table, 78, true);
  for (const Fault& fault : table) {
    EXPECT_NEAR(bench.Estimate(all, fault.name), fault.value - 1.0,
                0.01 * std::abs(fault.value - 1.0))
        << fault.name;
  }
}

TEST(Diagnosis, RaisesNoAlarmOnAHealthyMachine) {
  Bench bench;
  bench.Calibrate(true);
  // The residual is normal with standard deviation 1 and has, in twenty quarters of a
  // second under a low-pass of 50 Hz, some 1600 independent samples: 4.5 is passed by
  // one in 150000.
  EXPECT_GT(bench.design.limits.residual.limits.max, 4.5);
  EXPECT_LT(bench.design.limits.residual.limits.min, -4.5);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_FALSE(bench.MonitorOf({}, seed, true).first_detection().has_value()) << seed;
  }
}

TEST(DesignFilters, LeavesNothingOfALinearRunWithoutNoise) {
  const Bench bench;
  const MatrixXd signals = Signals(bench.design, LinearRun(bench.machine));
  EXPECT_GT(signals.cwiseAbs().maxCoeff(), 100.0) << "does not move";
  const MatrixXd outputs = FilterSignals(bench.design.bank.filters, signals);
  // A small part of the noise that 20 nm leave, which is 1.
  EXPECT_LT(outputs.row(0).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_GT(outputs.bottomRows(7).rowwise().norm().minCoeff(), 1.0);
}

TEST(Signals, AreDeviationsFromRest) {
  const Bench bench;
  Record record(bench.machine.rates().tick());
  for (const char* name : {"u_z", "z", "u_y", "y", "u_x", "x"}) {
    record.Add(
        {name, "m", VectorXd::LinSpaced(3, 1.0, 3.0) * std::string(name).size()});
  }
  const MatrixXd signals = Signals(bench.design, record);
  for (Index i = 0; i < 3; ++i) {
    EXPECT_EQ(signals(i, 2), 3.0 - bench.design.offset[i]);
    EXPECT_EQ(signals(3 + i, 2), 9.0);
  }
}

TEST(ResidualBaseline, TakesOutWhatTheLinearModelLacks) {
  const Bench bench;
  const MatrixXd baseline = ResidualBaseline(bench.design, bench.machine, bench.motion,
                                             bench.Nominal(false, 4));
  ASSERT_EQ(baseline.cols(), bench.motion.samples());
  NominalRuns others = bench.Nominal(false, 4);
  others.seed = 2001;
  const auto width = [](const DiagnosisLimits& limits) {
    return limits.residual.limits.max - limits.residual.limits.min;
  };
  const double with = width(
      CalibrateLimits(bench.design, bench.machine, bench.motion, baseline, others));
  const double without =
      width(CalibrateLimits(bench.design, bench.machine, bench.motion, {}, others));
  EXPECT_LT(with, 0.5 * without);
}

// The force is that of the x-motor, which acts along the joint X.
TEST(UnknownForces, LeaveResidualsThatAreBlindToThem) {
  const auto disturbed = [](const std::string& unknown) {
    Bench bench({"diagnosis.unknown_forces=" + unknown, "diagnosis.degree=10",
                 "diagnosis.order=10", "diagnosis.cutoff=200",
                 "diagnosis.disturbance.order=10"});
    DiagnosisRecording recording(bench.design, bench.motion.samples());
    mjdiag::Setup shaken = bench.machine.setup();
    shaken.disturbances[0].amplitude = {{"u_x", 100.0}};
    RunOptions options;
    options.disturbances["gamma"] = 0.05;
    bench.Watch(recording, bench.machine.WithSetup(shaken), options, true);
    return recording.recorder.Log().residual.cwiseAbs().maxCoeff();
  };
  EXPECT_GT(disturbed("[]"), 20.0);
  EXPECT_LT(disturbed(R"(["X"])"), 6.0);  // noise of standard deviation 1
}

std::string ErrorWith(const std::string& override_text) {
  return test::MessageOf<InputError>([&] { Bench bench({override_text}); });
}

TEST(DesignFilters, NamesTheJointsIfAnUnknownForceActsOnNone) {
  std::string joints;
  for (const std::string& joint : Bonder().linear().coordinates) {
    joints += (joints.empty() ? "" : ", ") + joint;
  }
  EXPECT_EQ(ErrorWith(R"(diagnosis.unknown_forces=["W"])"),
            "setup 'AB383 wire bonder': diagnosis.unknown_forces: there is no joint "
            "'W'; expected one of " +
                joints);
}

TEST(DesignFilters, NamesTheParametersIfAMagnitudeIsOfNone) {
  EXPECT_EQ(
      ErrorWith("diagnosis.estimation.magnitudes.zeta_q=0.01"),
      "setup 'AB383 wire bonder': diagnosis.estimation.magnitudes: the plant has "
      "no fault parameter 'zeta_q'; expected one of zeta_x, zeta_y, beta_x, beta_y, "
      "eta_x, eta_y, eta_z");
}

TEST(DesignFilters, SaysWhichDegreeThePlantNeeds) {
  EXPECT_EQ(
      ErrorWith("diagnosis.degree=5"),
      "residual: no parity relation of degree 5; expected a degree of at least 6");
}

TEST(DesignFilters, RefusesADenominatorBelowTheDegree) {
  EXPECT_EQ(ErrorWith("diagnosis.order=6"),
            "denominator: order 6; expected at least the degree of the numerator, 7");
}

TEST(DesignFilters, RefusesASamplingThatIsNoMultipleOfTheTick) {
  const auto message = [](const std::string& seconds) {
    return "setup 'AB383 wire bonder': diagnosis.estimation.sampling: " + seconds +
           " s; expected a multiple of the control tick";
  };
  EXPECT_EQ(ErrorWith("diagnosis.estimation.sampling=0.0003"), message("0.000300"));
  EXPECT_EQ(ErrorWith("diagnosis.estimation.sampling=1e-5"), message("0.000010"));
  EXPECT_EQ(Bench({"diagnosis.estimation.sampling=0.002"}).design.decimation, 16);
}

TEST(Run, RefusesARecordAtAnotherRate) {
  const Bench bench;
  DiagnosisMonitor monitor(bench.design);
  Record record(1e-3);
  record.Add({"x", "m", VectorXd::Zero(10)});
  EXPECT_THAT(test::MessageOf<InputError>([&] { mjdiag::Run(monitor, record); }),
              AllOf(HasSubstr("sampled every 1.0"), HasSubstr("0.125")));
}

}  // namespace
}  // namespace mjdiag
