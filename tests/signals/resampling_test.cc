#include "mjdiag/signals/resampling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kTick = 0.001;  // s

std::string RowOf(Index k) { return "row " + std::to_string(k); }

SampleGrid Choose(const VectorXd& times, double sample_time = kTick) {
  return ChooseGrid(times, sample_time, RowOf);
}

/// Uniform times with errors of that share of a tick.
VectorXd Jittered(Index samples, double share) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> error(-share, share);
  return VectorXd::NullaryExpr(samples, [&](Index k) {
    return kTick * (static_cast<double>(k) + (k == 0 ? 0.0 : error(random)));
  });
}

VectorXd Without(const VectorXd& times, Index first, Index count) {
  VectorXd fewer(times.size() - count);
  fewer << times.head(first), times.tail(times.size() - first - count);
  return fewer;
}

double Motion(double t) { return std::sin(40.0 * t) + 0.3 * std::cos(170.0 * t); }

VectorXd MotionAt(const VectorXd& times) { return times.unaryExpr(&Motion); }

VectorXd TimesOf(const SampleGrid& grid) {
  return VectorXd::NullaryExpr(grid.samples, [&](Index k) {
    return grid.time.start + static_cast<double>(k) * grid.time.sample_time;
  });
}

TEST(ChosenGrid, IsThatOfTheFileWhereItsTimesAreUniform) {
  const SampleGrid grid = Choose(VectorXd::LinSpaced(101, 0.5, 0.6));
  EXPECT_TRUE(grid.IsOfFile());
  EXPECT_EQ(grid.samples, 101);
  EXPECT_EQ(grid.time.sample_time, kTick);
}

TEST(ChosenGrid, IsTheWantedOneWhereTimesAreIrregular) {
  const SampleGrid grid = Choose(Jittered(2000, 0.2));
  EXPECT_EQ(grid.time.sample_time, kTick);
  EXPECT_NEAR(static_cast<double>(grid.samples), 2000.0, 1.0);
  // Two errors of 0.2 / sqrt(3) make an interval.
  EXPECT_THAT(grid.note, HasSubstr("time stamps are irregular (their intervals vary by "
                                   "16 %): resampled to 1.00 ms"));
}

TEST(ChosenGrid, BridgesTwoMissingSamplesAndSaysSo) {
  const SampleGrid grid = Choose(Without(VectorXd::LinSpaced(101, 0.0, 0.1), 40, 2));
  EXPECT_EQ(grid.samples, 101);
  EXPECT_THAT(grid.note, HasSubstr("2 samples are missing"));
}

TEST(ChosenGrid, GoesOnThroughLongerGaps) {
  const SampleGrid grid = Choose(Without(VectorXd::LinSpaced(101, 0.0, 0.1), 40, 30));
  EXPECT_EQ(grid.samples, 101);
  EXPECT_EQ(grid.time.sample_time, kTick);
  EXPECT_THAT(grid.note, HasSubstr("30 samples are missing: resampled"));
}

TEST(ChosenGrid, IsTheWantedOneAtNearlyItsRate) {
  const SampleGrid grid = Choose(VectorXd::LinSpaced(1001, 0.0, 1.002));
  EXPECT_EQ(grid.time.sample_time, kTick);
  EXPECT_EQ(grid.samples, 1003);
  EXPECT_THAT(grid.note,
              HasSubstr("the sample time is 0.20 % off the control tick: resampled"));
}

TEST(ChosenGrid, IsTheWantedOneAtAnotherRate) {
  const SampleGrid uniform = Choose(VectorXd::LinSpaced(101, 0.0, 0.2));
  EXPECT_EQ(uniform.samples, 201);
  EXPECT_THAT(uniform.note, HasSubstr("samples are 2.00 ms apart, not a control tick"));
  EXPECT_EQ(Choose(2.0 * Jittered(200, 0.2)).time.sample_time, kTick);
}

// As of a logger whose first interval is one of its own.
TEST(ChosenGrid, IsWhereMostSamplesAre) {
  VectorXd times(101);
  times << 0.0, VectorXd::LinSpaced(100, 0.3 * kTick, 99.3 * kTick);
  const SampleGrid grid = Choose(times);
  EXPECT_NEAR(grid.time.start, 0.3 * kTick, 1e-2 * kTick);
  EXPECT_EQ(grid.samples, 100);
}

TEST(ChosenGrid, LeavesOutAFirstSampleThatIsOutOfStepAndKeepsTheOthers) {
  VectorXd times(101);
  times << 0.0, VectorXd::LinSpaced(100, 0.3 * kTick, 99.3 * kTick);
  const SampleGrid grid = Choose(times);
  EXPECT_THAT(grid.note, HasSubstr("the first sample, which is out of step"));
  const VectorXd x = VectorXd::LinSpaced(101, 0.0, 100.0).cwiseAbs2();
  const auto off = [&](Course course) {
    return (Resample(times, x, grid, course) - x.tail(100)).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(off(Course::kSmooth), 1e-9);
  // What is held changes within a ten thousandth of a tick of its sample, here by up to 199.
  EXPECT_LT(off(Course::kHeld), 1e-4 * 200.0);
}

TEST(ChosenGrid, IsThatOfAClockOfTheFilesOwnIfItIsToBeKept) {
  const VectorXd times = VectorXd::LinSpaced(1001, 0.0, 1.002);
  const SampleGrid grid = ChooseGrid(times, kTick, RowOf, 0.01);
  EXPECT_TRUE(grid.IsOfFile());
  EXPECT_NEAR(grid.time.sample_time, 1.002 * kTick, 1e-12);
  EXPECT_FALSE(ChooseGrid(times, kTick, RowOf, 0.001).IsOfFile());
}

TEST(ChosenGrid, RefusesTimesInAnotherUnit) {
  EXPECT_THAT([] { Choose(1000.0 * Jittered(200, 0.2)); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("the control tick of the setup is 1.00 ms"),
                        HasSubstr("the unit of its times under [record.time]"))));
}

TEST(Resampled, SmoothSignalIsWhatItWouldHaveBeen) {
  const VectorXd times = Without(Jittered(2000, 0.2), 700, 1);
  const SampleGrid grid = Choose(times);
  const VectorXd x = Resample(times, MotionAt(times), grid, Course::kSmooth);
  const VectorXd expected = MotionAt(TimesOf(grid));
  EXPECT_LT((x - expected).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((x - expected).norm(), 1e-4 * expected.norm());
  const VectorXd line = Resample(times, 3.0 * times, grid, Course::kStraight);
  EXPECT_LT((line - 3.0 * TimesOf(grid)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Resampled, RestStaysExact) {
  const VectorXd times = Jittered(300, 0.3);
  const VectorXd rest = VectorXd::Constant(300, 0.1);
  const SampleGrid grid = Choose(times);
  for (const Course course :
       {Course::kSmooth, Course::kStraight, Course::kHeld, Course::kSwitched}) {
    EXPECT_EQ(Resample(times, rest, grid, course),
              VectorXd::Constant(grid.samples, 0.1));
  }
}

TEST(Resampled, HeldSignalKeepsItsImpulse) {
  const VectorXd times = Jittered(500, 0.3);
  const VectorXd force = MotionAt(times);
  const SampleGrid grid = Choose(times);
  const VectorXd held = Resample(times, force, grid, Course::kHeld);
  double impulse = 0.0;
  for (Index k = 0; k + 1 < times.size(); ++k) {
    impulse += force[k] * (times[k + 1] - times[k]);
  }
  const double behind = grid.time.start + static_cast<double>(grid.samples) * kTick -
                        times[times.size() - 1];
  impulse += force[force.size() - 1] * behind;
  EXPECT_NEAR(kTick * held.sum(), impulse, 1e-5 * kTick * held.cwiseAbs().sum());
}

// One that changes at every tick of the wanted grid goes through unchanged.
TEST(Resampled, HeldSignalOfTheGridIsItself) {
  const VectorXd times = Without(VectorXd::LinSpaced(101, 0.0, 0.1), 100, 1);
  const SampleGrid grid{{0.0, kTick}, 100, "rounded"};
  const VectorXd force = MotionAt(times);
  const VectorXd held = Resample(times, force, grid, Course::kHeld);
  EXPECT_LT((held - force).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(Resampled, SwitchHasNoValuesBetweenItsOwn) {
  const VectorXd times = Jittered(400, 0.3);
  const VectorXd on =
      VectorXd::NullaryExpr(400, [](Index k) { return k / 37 % 2 == 0 ? 1.0 : 0.0; });
  const VectorXd resampled = Resample(times, on, Choose(times), Course::kSwitched);
  for (const double value : resampled) EXPECT_TRUE(value == 0.0 || value == 1.0);
  EXPECT_NEAR(resampled.mean(), on.mean(), 0.02);
}

}  // namespace
}  // namespace mjdiag
