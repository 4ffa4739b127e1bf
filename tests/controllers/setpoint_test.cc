#include "mjdiag/controllers/setpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kTick = 1.0 / 8000.0;

struct Case {
  double distance;
  MoveLimits limits;
  double sample_time;
};

/// Bounds and distances over many orders of magnitude, so that every combination of
/// phases occurs.
std::vector<Case> RandomCases(int count) {
  std::mt19937_64 generator(20230815);
  std::uniform_real_distribution<double> exponent(-2.0, 3.0);
  const auto factor = [&] { return std::pow(10.0, exponent(generator) / 2.0); };
  std::vector<Case> cases;
  for (int i = 0; i < count; ++i) {
    // In units of 10 ticks a ratio of neighbouring derivatives is about 1.
    const double time = 10 * kTick;
    Case c{.distance = 1e-3 * factor(), .limits = {}, .sample_time = kTick};
    c.limits.velocity = c.distance / time / factor();
    c.limits.acceleration = c.limits.velocity / time / factor();
    c.limits.jerk = c.limits.acceleration / time / factor();
    c.limits.snap = c.limits.jerk / time / factor();
    if (i % 2 == 1) c.distance = -c.distance;
    cases.push_back(c);
  }
  return cases;
}

Setpoint Plan(const Case& c) { return {c.distance, c.limits, c.sample_time}; }

/// The ends of the phases: where jerk, acceleration and velocity have their extremes.
std::vector<double> PhaseEnds(const PhaseTicks& n) {
  const long sequence[] = {n.snap, n.jerk,         n.snap,     n.acceleration, n.snap,
                           n.jerk, n.snap,         n.velocity, n.snap,         n.jerk,
                           n.snap, n.acceleration, n.snap,     n.jerk,         n.snap};
  std::vector<double> ends;
  long end = 0;
  for (const long ticks : sequence) {
    end += ticks;
    ends.push_back(static_cast<double>(end));
  }
  return ends;
}

TEST(Setpoint, KeepsEveryBound) {
  for (const Case& c : RandomCases(3000)) {
    const Setpoint setpoint = Plan(c);
    constexpr double kSlack = 1.0 + 1e-8;
    for (const double end : PhaseEnds(setpoint.phases())) {
      const Motion m = setpoint.At(end);
      ASSERT_LE(std::abs(m.velocity), c.limits.velocity * kSlack);
      ASSERT_LE(std::abs(m.acceleration), c.limits.acceleration * kSlack);
      ASSERT_LE(std::abs(m.jerk), c.limits.jerk * kSlack);
      ASSERT_LE(std::abs(m.snap), c.limits.snap * kSlack);
    }
  }
}

TEST(Setpoint, EndsExactlyAtItsDistance) {
  for (const Case& c : RandomCases(3000)) {
    const Setpoint setpoint = Plan(c);
    const auto end = static_cast<double>(setpoint.ticks());
    EXPECT_EQ(setpoint.At(end).position, c.distance);
    // The last polynomial runs into that point, it is not jumped to.
    const double last = end * (1.0 - 1e-15);
    EXPECT_NEAR(setpoint.At(last).position, c.distance, 1e-12 * std::abs(c.distance));
  }
}

TEST(Setpoint, IsAtRestAtBothEndsAndBeyond) {
  for (const Case& c : RandomCases(1000)) {
    const Setpoint setpoint = Plan(c);
    const auto end = static_cast<double>(setpoint.ticks());
    for (const double ticks : {-5.0, 0.0, end * (1.0 - 1e-15), end, end + 7.0}) {
      const Motion m = setpoint.At(ticks);
      EXPECT_NEAR(m.velocity, 0.0, 1e-10 * c.limits.velocity);
      EXPECT_NEAR(m.acceleration, 0.0, 1e-10 * c.limits.acceleration);
      EXPECT_NEAR(m.jerk, 0.0, 1e-10 * c.limits.jerk);
    }
    EXPECT_EQ(setpoint.At(0.0).position, 0.0);
    EXPECT_EQ(setpoint.At(-1.0).snap, 0.0);
    EXPECT_EQ(setpoint.At(end).snap, 0.0);
  }
}

TEST(Setpoint, HasDerivativesThatAgree) {
  // Within a phase the position is a quartic, for which Simpson's rule integrates each
  // derivative exactly.
  for (const Case& c : RandomCases(500)) {
    const Setpoint setpoint = Plan(c);
    double begin = 0.0;
    for (const double end : PhaseEnds(setpoint.phases())) {
      if (end == begin) continue;
      const double inside = end - 1e-6;  // before the snap changes
      const Motion a = setpoint.At(begin);
      const Motion mid = setpoint.At(0.5 * (begin + inside));
      const Motion b = setpoint.At(inside);
      const double duration = (inside - begin) * kTick;
      const auto simpson = [&](double Motion::*rate) {
        return duration / 6.0 * (a.*rate + 4.0 * mid.*rate + b.*rate);
      };
      const double d = std::abs(c.distance);
      ASSERT_NEAR(b.position - a.position, simpson(&Motion::velocity), 1e-12 * d);
      ASSERT_NEAR(b.velocity - a.velocity, simpson(&Motion::acceleration),
                  1e-10 * c.limits.velocity);
      ASSERT_NEAR(b.acceleration - a.acceleration, simpson(&Motion::jerk),
                  1e-10 * c.limits.acceleration);
      ASSERT_NEAR(b.jerk - a.jerk, simpson(&Motion::snap), 1e-10 * c.limits.jerk);
      begin = end;
    }
  }
}

TEST(Setpoint, IsContinuousUpToTheJerk) {
  for (const Case& c : RandomCases(500)) {
    const Setpoint setpoint = Plan(c);
    for (const double end : PhaseEnds(setpoint.phases())) {
      constexpr double kGap = 1e-7;  // ticks
      const Motion before = setpoint.At(end - kGap);
      const Motion after = setpoint.At(end);
      ASSERT_NEAR(before.position, after.position, 1e-6 * std::abs(c.distance));
      ASSERT_NEAR(before.velocity, after.velocity, 1e-6 * c.limits.velocity);
      ASSERT_NEAR(before.acceleration, after.acceleration,
                  1e-6 * c.limits.acceleration);
      ASSERT_NEAR(before.jerk, after.jerk, 1.1 * kGap * kTick * c.limits.snap);
    }
  }
}

TEST(Setpoint, MovesBackAsItMovesForth) {
  for (const Case& c : RandomCases(200)) {
    const Setpoint forth = Plan(c);
    const Setpoint back(-c.distance, c.limits, c.sample_time);
    ASSERT_EQ(forth.ticks(), back.ticks());
    for (double k = 0.5; k < static_cast<double>(forth.ticks()); k += 3.0) {
      ASSERT_EQ(forth.At(k).position, -back.At(k).position);
      ASSERT_EQ(forth.At(k).snap, -back.At(k).snap);
    }
  }
}

/// Fewest ticks of any profile of 15 whole phases within the bounds, tried one by one.
long ShortestProfile(const Case& c) {
  const double t = c.sample_time;
  const double v = c.limits.velocity * t;
  const double a = c.limits.acceleration * t * t;
  const double j = c.limits.jerk * t * t * t;
  const double s = c.limits.snap * t * t * t * t;
  long best = std::numeric_limits<long>::max();
  for (long ts = 1; 8 * ts < best && ts < 200; ++ts) {
    for (long tj = 0; 8 * ts + 4 * tj < best && tj < 200; ++tj) {
      for (long ta = 0; 8 * ts + 4 * tj + 2 * ta < best && ta < 400; ++ta) {
        const auto rise = static_cast<double>(ts + tj);
        const auto ramp = static_cast<double>(2 * ts + tj + ta);
        const double reached = std::min(
            {v, a * ramp, j * rise * ramp, s * static_cast<double>(ts) * rise * ramp});
        const double cruise = std::abs(c.distance) / reached -
                              static_cast<double>(4 * ts + 2 * tj + ta) - 1e-9;
        const long tv = std::max(0L, static_cast<long>(std::ceil(cruise)));
        best = std::min(best, 8 * ts + 4 * tj + 2 * ta + tv);
      }
    }
  }
  return best;
}

TEST(Setpoint, IsTheShortestWithinTheRoundingToTicks) {
  // A snap phase that is rounded up costs up to eight ticks.
  int tried = 0;
  for (const Case& c : RandomCases(400)) {
    const Setpoint setpoint = Plan(c);
    if (setpoint.ticks() > 300) continue;
    ++tried;
    const long shortest = ShortestProfile(c);
    EXPECT_GE(setpoint.ticks(), shortest);
    EXPECT_LE(setpoint.ticks(), shortest + 8);
  }
  EXPECT_GT(tried, 100);
}

struct Degenerate {
  const char* name;
  double distance;
  MoveLimits limits;
  bool jerk, acceleration, velocity;  // which phases occur
};

class DegenerateSetpoint : public ::testing::TestWithParam<Degenerate> {};

TEST_P(DegenerateSetpoint, HasOnlyThePhasesThatItsBoundsAsk) {
  const Degenerate& c = GetParam();
  const Setpoint setpoint(c.distance, c.limits, kTick);
  EXPECT_GT(setpoint.phases().snap, 0);
  EXPECT_EQ(setpoint.phases().jerk > 0, c.jerk);
  EXPECT_EQ(setpoint.phases().acceleration > 0, c.acceleration);
  EXPECT_EQ(setpoint.phases().velocity > 0, c.velocity);
  EXPECT_EQ(setpoint.At(static_cast<double>(setpoint.ticks())).position, c.distance);
}

INSTANTIATE_TEST_SUITE_P(
    Phases, DegenerateSetpoint,
    ::testing::Values(
        Degenerate{"all", 0.1, {1, 100, 5e4, 5e7}, true, true, true},
        Degenerate{"no_velocity", 0.01, {1e3, 100, 5e4, 5e7}, true, true, false},
        Degenerate{"no_acceleration", 0.1, {0.1, 1e4, 5e3, 5e6}, true, false, true},
        Degenerate{"no_jerk", 0.1, {1, 30, 1e9, 1e7}, false, true, true},
        Degenerate{"jerk_only", 0.01, {1e3, 1e4, 5e3, 5e7}, true, false, false},
        Degenerate{"acceleration_only", 0.01, {1e3, 10, 1e9, 1e8}, false, true, false},
        Degenerate{"velocity_only", 0.1, {0.1, 1e6, 1e9, 1e6}, false, false, true},
        Degenerate{"snap_only", 0.004, {1e3, 1e6, 1e9, 1e7}, false, false, false},
        Degenerate{"tiny", 1e-12, {1, 100, 5e4, 5e7}, false, false, false},
        Degenerate{"back", -0.1, {1, 100, 5e4, 5e7}, true, true, true}),
    [](const auto& param_info) { return param_info.param.name; });

TEST(Setpoint, OfATinyDistanceTakesOneTickAPhase) {
  for (const double distance : {1e-15, -1e-60}) {
    const Setpoint setpoint(distance, {1, 100, 5e4, 5e7}, kTick);
    EXPECT_EQ(setpoint.ticks(), 8);
    EXPECT_EQ(setpoint.At(8.0).position, distance);
    EXPECT_NEAR(setpoint.At(4.0).position, distance / 2, 1e-15 * std::abs(distance));
  }
}

TEST(Setpoint, OfNoDistanceTakesNoTime) {
  const Setpoint setpoint(0.0, {1, 100, 5e4, 5e7}, kTick);
  EXPECT_EQ(setpoint.ticks(), 0);
  EXPECT_EQ(setpoint.At(0.0).position, 0.0);
  EXPECT_EQ(setpoint.At(0.0).snap, 0.0);
}

TEST(Setpoint, FindsThePhasesFromWhichItsBoundsWereMade) {
  // Bounds that a profile of whole ticks just reaches, and a bound out of reach for
  // every phase that is left out: there is only one shortest profile.
  std::mt19937_64 generator(4);
  std::uniform_int_distribution<long> ticks(1, 40);
  for (int i = 0; i < 800; ++i) {
    const PhaseTicks n{ticks(generator), i & 1 ? ticks(generator) : 0,
                       i & 2 ? ticks(generator) : 0, i & 4 ? ticks(generator) : 0};
    const double t_s = static_cast<double>(n.snap) * kTick;
    const double t_j = static_cast<double>(n.jerk) * kTick;
    const double t_a = static_cast<double>(n.acceleration) * kTick;
    const double t_v = static_cast<double>(n.velocity) * kTick;
    MoveLimits limits{.snap = 3e7};
    limits.jerk = limits.snap * t_s;
    limits.acceleration = limits.jerk * (t_s + t_j);
    limits.velocity = limits.acceleration * (2 * t_s + t_j + t_a);
    const double distance = limits.velocity * (4 * t_s + 2 * t_j + t_a + t_v);
    const MoveLimits reached = limits;
    if (n.jerk == 0) limits.jerk *= 100;
    if (n.acceleration == 0) limits.acceleration *= 100;
    if (n.velocity == 0) limits.velocity *= 100;

    const Setpoint setpoint(i & 8 ? -distance : distance, limits, kTick);
    ASSERT_EQ(setpoint.phases().snap, n.snap) << i;
    ASSERT_EQ(setpoint.phases().jerk, n.jerk) << i;
    ASSERT_EQ(setpoint.phases().acceleration, n.acceleration) << i;
    ASSERT_EQ(setpoint.phases().velocity, n.velocity) << i;
    ASSERT_NEAR(std::abs(setpoint.At(0.0).snap), reached.snap, 1e-9 * reached.snap);
  }
}

TEST(Setpoint, RefusesBoundsThatAreNotPositive) {
  const auto plan = [](double distance, MoveLimits limits, double sample_time) {
    return [=] { Setpoint(distance, limits, sample_time); };
  };
  const double nan = std::nan("");
  EXPECT_THAT(plan(1, {0, 1, 1, 1}, kTick),
              ThrowsMessage<InputError>(HasSubstr("velocity limit")));
  EXPECT_THAT(plan(1, {1, -1, 1, 1}, kTick),
              ThrowsMessage<InputError>(HasSubstr("acceleration limit")));
  EXPECT_THAT(plan(1, {1, 1, nan, 1}, kTick),
              ThrowsMessage<InputError>(HasSubstr("jerk limit")));
  EXPECT_THAT(plan(1, {1, 1, 1, 0}, kTick),
              ThrowsMessage<InputError>(HasSubstr("snap limit")));
  EXPECT_THAT(plan(1, {1, 1, 1, 1}, 0.0),
              ThrowsMessage<InputError>(HasSubstr("sample time")));
  EXPECT_THAT(plan(nan, {1, 1, 1, 1}, kTick),
              ThrowsMessage<InputError>(HasSubstr("distance")));
  EXPECT_THAT(plan(1e9, {1e-9, 1, 1, 1}, kTick),
              ThrowsMessage<InputError>(HasSubstr("control ticks")));
}

}  // namespace
}  // namespace mjdiag
