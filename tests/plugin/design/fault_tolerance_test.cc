#include "mjdiag/plugin/design/fault_tolerance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/design/known_faults.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/count_allocations.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;

/// Rms of a tracking error from a time to the end.
double Rms(const Record& record, const std::string& axis, double from) {
  const Eigen::VectorXd error =
      record.At(axis + "_ref").samples - record.At(axis).samples;
  const auto first = static_cast<Eigen::Index>(from / record.sample_time());
  const Eigen::VectorXd rest = error.tail(error.size() - first);
  return std::sqrt(rest.squaredNorm() / static_cast<double>(rest.size()));
}

class Tolerance : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    bonder_ = std::make_unique<Machine>(test::Bonder());
    plan_ = std::make_unique<TolerancePlan>(PlanTolerance(*bonder_));
  }
  static void TearDownTestSuite() {
    plan_.reset();
    bonder_.reset();
  }

  static Excitation Motion(double duration) {
    Trajectory trajectory = bonder_->setup().trajectories.Find("multi");
    trajectory.duration = duration;
    return FollowTrajectory(bonder_->setup(), trajectory);
  }
  static Record Run(const RunOptions& options, bool linear, double duration = 0.75) {
    return linear ? SimulateLinear(*bonder_, Motion(duration), options)
                  : Simulate(*bonder_, Motion(duration), options);
  }
  /// Corrected by somebody who knows.
  static Record RunKnown(RunOptions options, bool linear, double duration = 0.75) {
    Reconfiguration reconfiguration(plan_->axes, plan_->remedies, plan_->options);
    KnownFaults known(reconfiguration, bonder_->setup(), options.late_faults, 0.02,
                      1e-6);
    options.observer = &known;
    options.reconfiguration = &reconfiguration;
    Record record = Run(options, linear, duration);
    summary_ = Summarise(reconfiguration, bonder_->setup());
    return record;
  }
  /// Corrected by the diagnosis in the callback.
  static Record RunWatched(RunOptions options, bool linear, double duration) {
    DiagnosisMonitor monitor(DesignFilters(*bonder_));
    monitor.Follow(MakeTwinEstimator(*bonder_, linear));
    MonitorObserver watched(monitor);
    FaultTolerance tolerance(*plan_, monitor, watched);
    options.observer = &tolerance;
    options.reconfiguration = &tolerance.reconfiguration();
    Record record = Run(options, linear, duration);
    summary_ = Summarise(tolerance.reconfiguration(), bonder_->setup());
    return record;
  }

  static std::unique_ptr<Machine> bonder_;
  static std::unique_ptr<TolerancePlan> plan_;
  static std::vector<Tolerated> summary_;
};

std::unique_ptr<Machine> Tolerance::bonder_;
std::unique_ptr<TolerancePlan> Tolerance::plan_;
std::vector<Tolerated> Tolerance::summary_;

TEST_F(Tolerance, BringsTheTrackingErrorBackOnBothPlants) {
  const std::vector<std::vector<Fault>> cases = {
      {{"eta_x", 0.7}},
      {{"zeta_x", 2.0}},
      {{"gamma", 1.0}},
      {{"eta_x", 0.7}, {"zeta_x", 2.0}, {"gamma", 1.0}}};
  for (const bool linear : {true, false}) {
    const Record healthy = Run({}, linear);
    for (const std::vector<Fault>& faults : cases) {
      RunOptions options;
      for (const Fault& fault : faults) options.late_faults.push_back({fault, 0.1});
      const Record corrected = RunKnown(options, linear);
      EXPECT_EQ(summary_.size(), faults.size());
      double worst = 0.0;
      const Record uncorrected = Run(options, linear);
      for (const char* axis : {"x", "y", "z"}) {
        const double was = Rms(healthy, axis, 0.5);
        EXPECT_LT(Rms(corrected, axis, 0.5), 1.1 * was) << faults[0].name << axis;
        worst = std::max(worst, Rms(uncorrected, axis, 0.5) / was);
      }
      EXPECT_GT(worst, 1.03) << "nothing to correct";
    }
  }
}

TEST_F(Tolerance, LeavesAHealthyRunUnchangedToTheLastBit) {
  const Record plain = Run({}, true, 0.5);
  const Record watched = RunWatched({}, true, 0.5);
  EXPECT_TRUE(summary_.empty());
  for (const char* channel : {"x", "z", "u_x", "u_y"}) {
    EXPECT_EQ(plain.At(channel).samples, watched.At(channel).samples);
  }
}

TEST_F(Tolerance, GoesBackWhenTheFaultHasGone) {
  RunOptions options;
  options.late_faults = {{{"eta_x", 0.7}, 0.05}, {{"eta_x", 1.0}, 0.3}};
  const Record run = RunKnown(options, true);
  ASSERT_EQ(summary_.size(), 1u);
  EXPECT_EQ(summary_[0].action, "drive gain of x");
  EXPECT_FALSE(summary_[0].acting);
  EXPECT_NEAR(summary_[0].value, 1.0, 1e-4);
  EXPECT_NEAR(summary_[0].since, 0.05 + 0.02 + plan_->options.persistence, 1e-3);
  EXPECT_NEAR(summary_[0].until, 0.32, 1e-3);
  EXPECT_NEAR(Rms(run, "x", 0.6), Rms(Run({}, true), "x", 0.6), 2e-8);
}

TEST_F(Tolerance, ActsOnWhatTheTwinFinds) {
  RunOptions options;
  options.late_faults = {{{"eta_x", 0.7}, 0.0}, {{"zeta_x", 2.0}, 0.0}};
  const Record run = RunWatched(options, true, 1.0);
  ASSERT_EQ(summary_.size(), 2u);
  EXPECT_EQ(summary_[0].fault, "zeta_x");
  EXPECT_EQ(summary_[0].action, "feedforward");
  // As it was when it became certain: while the twin catches up, nothing is changed.
  EXPECT_NEAR(summary_[0].value, 2.0, 1e-3);
  EXPECT_NEAR(summary_[1].value, 0.7, 1e-3);
  EXPECT_LT(summary_[1].since, 0.1);
  EXPECT_LT(Rms(run, "x", 0.75), 1.1 * Rms(Run({}, true, 1.0), "x", 0.75));
}

TEST_F(Tolerance, CancelsTonesWhosePhasesTheTwinFinds) {
  RunOptions options;
  // So small that the run begins as one at rest.
  options.late_faults = {{{"gamma", 0.01}, 0.0}};
  const Record run = RunWatched(options, true, 1.0);
  const Record healthy = Run({}, true, 1.0);
  ASSERT_EQ(summary_.size(), 1u);
  EXPECT_EQ(summary_[0].action, "tones cancelled");
  const double left = (run.At("y").samples - healthy.At("y").samples).tail(800).norm();
  const double all = (Run(options, true, 1.0).At("y").samples - healthy.At("y").samples)
                         .tail(800)
                         .norm();
  EXPECT_LT(left, 0.01 * all);
}

TEST_F(Tolerance, ActsOnWhatAppearsMidway) {
  RunOptions options;
  options.late_faults = {
      {{"eta_x", 0.7}, 0.5}, {{"zeta_x", 2.0}, 0.5}, {{"gamma", 1.0}, 0.5}};
  for (const bool linear : {true, false}) {
    const Record healthy = Run({}, linear, 2.5);
    const Record run = RunWatched(options, linear, 2.5);
    EXPECT_EQ(summary_.size(), 3u);
    for (const char* axis : {"x", "y", "z"}) {
      EXPECT_LT(Rms(run, axis, 2.0), 1.1 * Rms(healthy, axis, 2.0)) << axis;
    }
  }
}

TEST_F(Tolerance, AllocatesNothingInTheCallback) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "malloc belongs to the sanitizer";
  DiagnosisMonitor monitor(DesignFilters(*bonder_));
  monitor.Follow(MakeTwinEstimator(*bonder_, true));
  MonitorObserver watched(monitor);
  FaultTolerance tolerance(*plan_, monitor, watched);
  const std::array readings{0.0, 0.0, 0.0};
  const std::array commands{1.0, 1.0, 0.01};
  const std::array<ReferenceSample, 3> references{};
  EXPECT_EQ(test::CountAllocations([&] {
              for (int k = 0; k < 400; ++k) {
                tolerance.reconfiguration().Correct(references);
                tolerance.OnTick(readings, commands);
              }
            }),
            0);
}

TEST_F(Tolerance, LeavesFeedforwardAloneWhereItDoesNotAct) {
  const TolerancePlan plan = PlanTolerance(*bonder_, ControlMode::kFeedback);
  for (const FaultRemedy& remedy : plan.remedies) {
    EXPECT_EQ(remedy.forces.velocity.size(), 0) << remedy.fault;
  }
}

TEST_F(Tolerance, NamesWhatItLacks) {
  const Machine coil(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/voice_coil"));
  EXPECT_THAT(test::MessageOf<InputError>([&] { PlanTolerance(coil); }),
              HasSubstr("has no controllers"));
  DiagnosisMonitor monitor(DesignFilters(*bonder_));
  MonitorObserver watched(monitor);
  EXPECT_THAT(
      test::MessageOf<InputError>([&] { FaultTolerance(*plan_, monitor, watched); }),
      HasSubstr("the diagnosis has no twin"));
  monitor.Follow(MakeTwinEstimator(*bonder_, true));
  TolerancePlan other = *plan_;
  other.remedies.pop_back();
  EXPECT_THAT(
      test::MessageOf<InputError>([&] { FaultTolerance(other, monitor, watched); }),
      HasSubstr("its faults are not those of the diagnosis"));
}

}  // namespace
}  // namespace mjdiag
