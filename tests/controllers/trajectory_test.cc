#include "mjdiag/controllers/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kTick = 1.0 / 8000.0;
const MoveLimits kLimits{0.6, 120.0, 6e4, 4e7};

Trajectory ThereAndBack() {
  return {.name = "there_and_back",
          .duration = 0.5,
          .period = 0.2,
          .moves = {{0.01, {{"x", 0.004}}},
                    {0.05, {{"x", 0.002}, {"y", -0.003}}},
                    {0.10, {{"x", -0.006}, {"y", 0.003}}}},
          .limits = {{"x", kLimits}, {"y", kLimits}},
          .tones = {},
          .ramp = 0.0};
}

Reference Sample(const Trajectory& trajectory) {
  return SampleTrajectory(trajectory, {"x", "y"}, kTick);
}

TEST(SampleTrajectory, CoversTheDurationForTheAxesInTheGivenOrder) {
  const Reference reference = SampleTrajectory(ThereAndBack(), {"y", "w", "x"}, kTick);
  EXPECT_EQ(reference.sample_time, kTick);
  EXPECT_EQ(reference.samples(), 4000);
  ASSERT_EQ(reference.axes.size(), 3u);
  EXPECT_EQ(reference.axes[0].axis, "y");
  EXPECT_EQ(reference.axes[2].axis, "x");
  EXPECT_EQ(reference.axes[1].position, Eigen::VectorXd::Zero(4000));
  EXPECT_EQ(reference.axes[1].snap.size(), 4000);
}

TEST(SampleTrajectory, StartsEveryAxisOfAMoveTogetherAndAddsDistances) {
  const Reference reference = Sample(ThereAndBack());
  const AxisReference& x = reference.axes[0];
  const AxisReference& y = reference.axes[1];
  EXPECT_EQ(x.position[80], 0.0);
  EXPECT_GT(x.snap[80], 0.0);
  EXPECT_EQ(x.snap[79], 0.0);
  EXPECT_EQ(x.position[399], 0.004);
  EXPECT_GT(x.snap[400], 0.0);
  EXPECT_LT(y.snap[400], 0.0);
  EXPECT_DOUBLE_EQ(x.position[799], 0.006);
  EXPECT_EQ(y.position[799], -0.003);
}

TEST(SampleTrajectory, RepeatsEveryPeriodUntilTheDuration) {
  const AxisReference x = Sample(ThereAndBack()).axes[0];
  for (Eigen::Index k = 0; k < 1600; ++k) {
    ASSERT_NEAR(x.position[k], x.position[k + 1600], 1e-17);
    ASSERT_EQ(x.snap[k], x.snap[k + 1600]);
  }
  EXPECT_GT(x.snap[3200 + 80], 0.0);
}

TEST(SampleTrajectory, WithoutPeriodMovesOnce) {
  Trajectory trajectory = ThereAndBack();
  trajectory.period = 0.0;
  const AxisReference x = Sample(trajectory).axes[0];
  EXPECT_EQ(x.velocity.tail(2000), Eigen::VectorXd::Zero(2000));
  EXPECT_NEAR(x.position[3999], 0.0, 1e-17);
}

TEST(SampleTrajectory, CutsAMoveThatTheDurationEnds) {
  Trajectory trajectory = ThereAndBack();
  trajectory.duration = 0.015;
  const AxisReference x = Sample(trajectory).axes[0];
  EXPECT_EQ(x.position.size(), 120);
  EXPECT_GT(x.velocity[119], 0.0);
}

TEST(SampleTrajectory, SamplesDerivativesOfItsPosition) {
  const AxisReference x = Sample(ThereAndBack()).axes[0];
  // The third-order remainder of a central difference: snap T^2 / 6 and so on.
  for (Eigen::Index k = 1; k + 1 < x.position.size(); ++k) {
    const double velocity = (x.position[k + 1] - x.position[k - 1]) / (2 * kTick);
    ASSERT_NEAR(velocity, x.velocity[k], kLimits.jerk * kTick * kTick / 6 * 1.01);
    const double acceleration = (x.velocity[k + 1] - x.velocity[k - 1]) / (2 * kTick);
    ASSERT_NEAR(acceleration, x.acceleration[k], kLimits.snap * kTick * kTick / 2);
    const double jerk_change =
        (x.acceleration[k + 1] - 2 * x.acceleration[k] + x.acceleration[k - 1]) / kTick;
    const double mean_snap = 0.5 * (x.snap[k] + x.snap[k - 1]) * kTick;
    ASSERT_NEAR(jerk_change, mean_snap, 1e-6 * kLimits.jerk);
  }
}

TEST(SampleTrajectory, TakesStartsToTheNearestTick) {
  for (const double off : {-0.4, 0.4}) {
    Trajectory trajectory = ThereAndBack();
    trajectory.moves[0].at = 0.01 + off * kTick;
    EXPECT_EQ(Sample(trajectory).axes[0].position,
              Sample(ThereAndBack()).axes[0].position);
  }
}

void ExpectRefused(const Trajectory& trajectory, const std::string& what) {
  EXPECT_THAT([&] { Sample(trajectory); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("trajectory 'there_and_back'"), HasSubstr(what))));
}

TEST(SampleTrajectory, NamesTheMoveThatCannotBe) {
  Trajectory t = ThereAndBack();
  t.limits.erase("y");
  ExpectRefused(t, "move 2 at 0.05 s, axis 'y': the axis has no limits");

  t = ThereAndBack();
  t.limits["x"].jerk = 0.0;
  ExpectRefused(t, "move 1 at 0.01 s, axis 'x': move: jerk limit is not positive");

  t = ThereAndBack();
  t.moves[1].at = 0.02;
  ExpectRefused(t, "move 2 at 0.02 s, axis 'x': starts before the previous move");

  t = ThereAndBack();
  t.moves[2].at = 0.195;
  ExpectRefused(t,
                "move 3 at 0.195 s, axis 'x': has not ended when the period repeats");

  t = ThereAndBack();
  t.moves[2].at = 0.2;
  ExpectRefused(t, "move 3 at 0.2 s, axis 'x': starts outside the period");

  t = ThereAndBack();
  t.moves[0].by = {{"w", 0.001}};
  ExpectRefused(t, "move 1 at 0.01 s, axis 'w': there is no such axis");

  t = ThereAndBack();
  t.duration = 0.0;
  ExpectRefused(t, "lasts less than a control tick");

  t = ThereAndBack();
  t.period = 1e-9;
  ExpectRefused(t, "repeats within a control tick");
}

TEST(SampleTrajectory, SaysWhereAMoveCouldStart) {
  Trajectory t = ThereAndBack();
  t.moves[1].at = 0.02;
  const auto earliest = [&] {
    const Setpoint first(0.004, kLimits, kTick);
    std::ostringstream text;
    text << "a start at " << (0.01 + static_cast<double>(first.ticks()) * kTick)
         << " s";
    return text.str();
  };
  ExpectRefused(t, earliest());
}

Trajectory WithTone(double frequency) {
  Trajectory t = ThereAndBack();
  t.tones = {{"x", frequency, 1e-5, 0.7}};
  t.ramp = 0.1;
  return t;
}

TEST(SampleTrajectory, AddsTonesThatBeginAndEndAtRest) {
  const Trajectory with = WithTone(40.0);
  const Reference both = Sample(with);
  const Reference moves = Sample(ThereAndBack());
  const auto tone = [&](const Eigen::VectorXd AxisReference::*part, Eigen::Index k) {
    return (both.axes[0].*part)[k] - (moves.axes[0].*part)[k];
  };
  // Flat in between: the sine as it is given.
  const double omega = 2.0 * M_PI * 40.0;
  const double time = 2000 * kTick;
  EXPECT_NEAR(tone(&AxisReference::position, 2000), 1e-5 * std::sin(omega * time + 0.7),
              1e-15);
  EXPECT_NEAR(tone(&AxisReference::snap, 2000),
              1e-5 * std::pow(omega, 4) * std::sin(omega * time + 0.7), 1e-6);
  for (const auto part : {&AxisReference::position, &AxisReference::velocity,
                          &AxisReference::acceleration, &AxisReference::snap}) {
    EXPECT_EQ(tone(part, 0), 0.0);
    // A tick before the end: of what it is in between.
    EXPECT_LT(std::abs(tone(part, 3999)), 1e-3 * std::abs(tone(part, 2100)));
  }
  EXPECT_EQ(both.axes[1].position, moves.axes[1].position);
}

// Central differences, whose error is that of h^2 / 6 times a derivative two orders up.
TEST(SampleTrajectory, TonesHaveTheDerivativesThatTheySay) {
  Trajectory t = WithTone(40.0);
  t.moves.clear();
  const AxisReference x = Sample(t).axes[0];
  const double omega = 2.0 * M_PI * 40.0;
  for (const Eigen::Index k : {100, 400, 790, 2000, 3300, 3900}) {
    const double bound = 1e-5 * std::pow(omega * kTick, 2);
    EXPECT_NEAR((x.position[k + 1] - x.position[k - 1]) / (2.0 * kTick), x.velocity[k],
                bound * omega);
    EXPECT_NEAR((x.velocity[k + 1] - x.velocity[k - 1]) / (2.0 * kTick),
                x.acceleration[k], bound * std::pow(omega, 2));
    EXPECT_NEAR(
        (x.acceleration[k + 1] - 2.0 * x.acceleration[k] + x.acceleration[k - 1]) /
            std::pow(kTick, 2),
        x.snap[k], bound * std::pow(omega, 4));
  }
}

TEST(SampleTrajectory, RefusesTonesThatNobodyCanFollow) {
  ExpectRefused(WithTone(4000.0), "a frequency that the control rate cannot follow");
  Trajectory t = WithTone(40.0);
  t.ramp = 0.0;
  ExpectRefused(t, "tones: have no ramp");
  t = WithTone(40.0);
  t.tones[0].axis = "w";
  ExpectRefused(t, "tones: there is no axis 'w'");
}

}  // namespace
}  // namespace mjdiag
