#include "mjdiag/controllers/axis_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "mjdiag/signals/error.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const FeedforwardGains kFeedforward{2.9926e-09, 0.0551, 1.9117};
/// The x compensator of Eq. 36 with its integrator on z = 1.
const DiscreteCompensator kFeedback{{838400.0, -1644080.7766043614, 806000.0},
                                    {1.0, -1.1185, 0.1185}};

std::vector<double> Noise(int count) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  std::vector<double> samples(static_cast<std::size_t>(count));
  for (double& sample : samples) sample = normal(generator);
  return samples;
}

/// The difference equation a0 u(k) = b0 e(k) + b1 e(k-1) + ... - a1 u(k-1) - ..., with
/// the numerator aligned to the denominator's lowest power.
std::vector<double> DifferenceEquation(const DiscreteCompensator& c,
                                       const std::vector<double>& e) {
  const std::size_t delay = c.denominator.size() - c.numerator.size();
  std::vector<double> u(e.size());
  for (std::size_t k = 0; k < e.size(); ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < c.numerator.size(); ++i) {
      if (k >= i + delay) sum += c.numerator[i] * e[k - i - delay];
    }
    for (std::size_t i = 1; i < c.denominator.size(); ++i) {
      if (k >= i) sum -= c.denominator[i] * u[k - i];
    }
    u[k] = sum / c.denominator[0];
  }
  return u;
}

TEST(FeedforwardFeedback, FollowsTheDifferenceEquation) {
  const std::vector<DiscreteCompensator> compensators = {
      kFeedback,
      {{12230.0, -11920.0}, {1.0, -0.7891}},
      {{3.0}, {2.0}},
      {{1.0}, {2.0, -1.0, 0.25}},  // strictly proper
      {{1.0, 0.5}, {4.0, -1.0, 0.25, 0.1}}};
  const std::vector<double> error = Noise(200);
  for (const DiscreteCompensator& c : compensators) {
    const auto controller = MakeFeedforwardFeedback({}, c, ControlMode::kBoth);
    const std::vector<double> expected = DifferenceEquation(c, error);
    double scale = 0.0;
    for (const double u : expected) scale = std::max(scale, std::abs(u));
    for (std::size_t k = 0; k < error.size(); ++k) {
      ASSERT_NEAR(controller->Update({.position = error[k]}, 0.0, 0.0), expected[k],
                  1e-12 * scale);
    }
  }
}

TEST(FeedforwardFeedback, ActsOnReferenceMinusMeasured) {
  const auto controller =
      MakeFeedforwardFeedback({}, {{2.0}, {1.0}}, ControlMode::kBoth);
  EXPECT_DOUBLE_EQ(controller->Update({.position = 3.0}, 2.5, 0.0), 1.0);
}

TEST(FeedforwardFeedback, WeighsTheDerivativesOfTheReference) {
  const auto controller =
      MakeFeedforwardFeedback(kFeedforward, kFeedback, ControlMode::kBoth);
  const ReferenceSample reference{
      .position = 1.0, .velocity = 0.5, .acceleration = 100.0, .snap = 4e7};
  EXPECT_DOUBLE_EQ(controller->Update(reference, 1.0, 0.0),
                   2.9926e-09 * 4e7 + 0.0551 * 100.0 + 1.9117 * 0.5);
}

TEST(FeedforwardFeedback, SplitsIntoItsTwoModes) {
  const auto both =
      MakeFeedforwardFeedback(kFeedforward, kFeedback, ControlMode::kBoth);
  const auto feedforward =
      MakeFeedforwardFeedback(kFeedforward, kFeedback, ControlMode::kFeedforward);
  const auto feedback =
      MakeFeedforwardFeedback(kFeedforward, kFeedback, ControlMode::kFeedback);
  for (const double sample : Noise(50)) {
    const ReferenceSample reference{sample, 2 * sample, 3 * sample, 1e6 * sample};
    const double measured = 0.3 * sample;
    const double forward = feedforward->Update(reference, measured, 0.0);
    EXPECT_DOUBLE_EQ(forward, 2.9926e-09 * reference.snap +
                                  0.0551 * reference.acceleration +
                                  1.9117 * reference.velocity);
    const double back = feedback->Update(reference, measured, 0.0);
    EXPECT_DOUBLE_EQ(both->Update(reference, measured, 0.0), forward + back);
  }
}

TEST(FeedforwardFeedback, AddsTheKnownDisturbanceInEveryMode) {
  for (const ControlMode mode :
       {ControlMode::kBoth, ControlMode::kFeedback, ControlMode::kFeedforward}) {
    const auto controller = MakeFeedforwardFeedback(kFeedforward, kFeedback, mode);
    EXPECT_EQ(controller->Update({}, 0.0, 0.7), 0.7);
  }
}

TEST(FeedforwardFeedback, WithARepairedIntegratorRampsOnAConstantError) {
  // Residue at z = 1: C(1)'s numerator over the rest of the denominator, 1 - 0.1185.
  const auto controller = MakeFeedforwardFeedback({}, kFeedback, ControlMode::kBoth);
  double before = 0.0;
  double after = 0.0;
  for (int k = 0; k < 4000; ++k) {
    before = after;
    after = controller->Update({.position = 1e-6}, 0.0, 0.0);
  }
  const double gain = (838400.0 - 1644080.7766043614 + 806000.0) / (1.0 - 0.1185);
  EXPECT_NEAR(after - before, 1e-6 * gain, 1e-6 * 1e-6 * gain);
}

TEST(FeedforwardFeedback, ResetForgetsTheErrorAndStaysSilentAtRest) {
  const auto controller =
      MakeFeedforwardFeedback(kFeedforward, kFeedback, ControlMode::kBoth);
  for (const double sample : Noise(20)) controller->Update({}, sample, 0.0);
  controller->Reset(0.25);
  EXPECT_EQ(controller->Update({.position = 0.25}, 0.25, 0.0), 0.0);
}

TEST(FeedforwardFeedback, RefusesACompensatorThatIsNone) {
  const auto make = [](const DiscreteCompensator& c) {
    return [c] { MakeFeedforwardFeedback({}, c, ControlMode::kBoth); };
  };
  EXPECT_THAT(make({{}, {1.0}}), ThrowsMessage<InputError>(HasSubstr("is empty")));
  EXPECT_THAT(make({{1.0}, {}}), ThrowsMessage<InputError>(HasSubstr("is empty")));
  EXPECT_THAT(make({{1.0}, {0.0, 1.0}}),
              ThrowsMessage<InputError>(HasSubstr("first coefficient")));
  EXPECT_THAT(make({{1.0, 2.0}, {1.0}}),
              ThrowsMessage<InputError>(HasSubstr("higher order")));
  EXPECT_THAT(make({{std::nan("")}, {1.0}}),
              ThrowsMessage<InputError>(HasSubstr("not finite")));
}

constexpr double kMillisecond = 1e-3;
const NestedLoops kEmps{
    .position_gain = 160.18, .velocity_gain = 243.45, .saturation = 10.0};

TEST(NestedLoops, FollowTheirEquation) {
  NestedLoops gains = kEmps;
  gains.saturation = 0.0;
  const auto controller = MakeNestedLoops(gains, kMillisecond);
  controller->Reset(0.1);
  std::vector<double> q = {0.1, 0.1};  // q(-2), q(-1)
  for (const double sample : Noise(100)) {
    q.push_back(0.1 + 1e-4 * sample);
    const std::size_t k = q.size() - 1;
    const double reference = 0.1 - 2e-4 * sample;
    const double dq =
        ((q[k] + q[k - 1]) / 2 - (q[k - 1] + q[k - 2]) / 2) / kMillisecond;
    const double expected =
        160.18 * 243.45 * (reference - q[k]) - 243.45 * dq + 0.5 * sample;
    ASSERT_NEAR(controller->Update({.position = reference}, q[k], 0.5 * sample),
                expected, 1e-10);
  }
}

TEST(NestedLoops, SaturateAfterTheKnownDisturbance) {
  const auto controller = MakeNestedLoops(kEmps, kMillisecond);
  controller->Reset(0.0);
  EXPECT_EQ(controller->Update({.position = 1.0}, 0.0, 0.0), 10.0);
  EXPECT_EQ(controller->Update({.position = -1.0}, 0.0, 0.0), -10.0);
  EXPECT_EQ(controller->Update({}, 0.0, 12.0), 10.0);
  EXPECT_EQ(controller->Update({}, 0.0, -3.0), -3.0);
}

TEST(NestedLoops, ResetHoldsThePosition) {
  const auto controller = MakeNestedLoops(kEmps, kMillisecond);
  for (const double sample : Noise(20)) controller->Update({}, sample, 0.0);
  controller->Reset(0.2);
  EXPECT_EQ(controller->Update({.position = 0.2}, 0.2, 0.0), 0.0);
}

TEST(NestedLoops, RefuseValuesThatMakeNoSense) {
  EXPECT_THROW(MakeNestedLoops(kEmps, 0.0), InputError);
  EXPECT_THROW(MakeNestedLoops({1.0, 1.0, -1.0}, kMillisecond), InputError);
  EXPECT_THROW(MakeNestedLoops({std::nan(""), 1.0, 1.0}, kMillisecond), InputError);
}

TEST(AxisController, WithAGainIsTheOneWhoseCommandIsMultiplied) {
  const auto made = [](bool nested) {
    return nested
               ? MakeNestedLoops(kEmps, kMillisecond)
               : MakeFeedforwardFeedback(kFeedforward, kFeedback, ControlMode::kBoth);
  };
  for (const bool nested : {false, true}) {
    const auto plain = made(nested);
    const auto gained = made(nested);
    gained->SetGain(1.25);
    for (const double sample : Noise(100)) {
      const ReferenceSample reference{.position = 2e-6 * sample, .velocity = 0.01};
      const double command = plain->Update(reference, 1e-6 * sample, 0.0);
      EXPECT_NEAR(gained->Update(reference, 1e-6 * sample, 0.5), 1.25 * command + 0.5,
                  1e-9);
    }
  }
}

// What an integrator has gathered is the load, whatever the drive.
TEST(FeedforwardFeedback, HoldsItsLoadThroughAChangeOfTheGain) {
  const auto controller = MakeFeedforwardFeedback({}, kFeedback, ControlMode::kBoth);
  double load = 0.0;
  for (int k = 0; k < 300; ++k) {
    load = controller->Update({.position = k < 100 ? 1e-6 : 0.0}, 0.0, 0.0);
  }
  ASSERT_NE(load, 0.0);
  controller->SetGain(1.4);
  EXPECT_NEAR(controller->Update({}, 0.0, 0.0), load, 1e-9 * std::abs(load));
}

TEST(AxisController, AllocatesNothingWhileItRuns) {
  const auto both =
      MakeFeedforwardFeedback(kFeedforward, kFeedback, ControlMode::kBoth);
  const auto nested = MakeNestedLoops(kEmps, kMillisecond);
  double sum = 0.0;
  const long allocated = test::CountAllocations([&] {
    for (AxisController* controller : {both.get(), nested.get()}) {
      controller->Reset(0.1);
      for (int k = 0; k < 100; ++k) {
        sum += controller->Update({.position = 0.1 * k}, 0.1, 0.0);
      }
    }
  });
  EXPECT_EQ(allocated, 0);
  EXPECT_EQ(test::allocations > 0, test::kCountsAllocations);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace mjdiag
