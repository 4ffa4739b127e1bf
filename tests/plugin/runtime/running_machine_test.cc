#include "mjdiag/plugin/runtime/running_machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using testing::HasSubstr;

class Readings final : public TickObserver {
 public:
  void OnTick(std::span<const double> outputs,
              std::span<const double>) noexcept override {
    all.insert(all.end(), outputs.begin(), outputs.end());
  }
  std::vector<double> all;
};

Machine WithMotor(const Machine& machine, double gain) {
  return machine.With({{{"eta_x", gain}}, {}});
}

// Both plants are affine in the strength of a motor, so that to become another evenly is
// to be the one in between at every tick.
TEST(RunningMachine, BecomesAnotherEvenly) {
  const Machine machine = test::Bonder();
  const Excitation motion = DefaultMotion(machine.setup());
  constexpr Index kTicks = 40;
  for (const auto start : {StartLinear, StartNonlinear}) {
    std::vector<Readings> readings(2);
    for (const bool evenly : {true, false}) {
      RunOptions options;
      options.observer = &readings[evenly ? 1 : 0];
      const auto running = start(machine, motion, options);
      for (Index k = 0; k < 60; ++k) running->Tick();
      if (evenly) running->Become(WithMotor(machine, 0.8), kTicks);
      for (Index k = 0; k < 2 * kTicks; ++k) {
        const double part = static_cast<double>(std::min(k + 1, kTicks)) / kTicks;
        if (!evenly) running->Become(WithMotor(machine, 1.0 - 0.2 * part));
        running->Tick();
      }
    }
    for (std::size_t i = 0; i < readings[0].all.size(); ++i) {
      ASSERT_NEAR(readings[1].all[i], readings[0].all[i], 1e-11) << i;
    }
  }
}

TEST(RunningMachine, RepeatsItsMotionAndKeepsItsFirstTimeOnly) {
  const Machine machine = test::Bonder({"trajectories.multi.duration=0.05"});
  const Excitation motion = DefaultMotion(machine.setup());
  RunOptions options;
  options.repeat = true;
  options.noise_scale = 0.0;
  Readings readings;
  options.observer = &readings;
  const auto running = StartLinear(machine, motion, options);
  for (Index k = 0; k < 3 * motion.samples(); ++k) running->Tick();
  EXPECT_EQ(running->ToRecord().samples(), motion.samples());
  const auto ticks = static_cast<std::size_t>(motion.samples());
  double largest = 0.0;
  for (std::size_t k = 0; k < ticks; ++k) {
    const double again = readings.all[3 * (2 * ticks + k)];
    largest = std::max(largest, std::abs(again));
    // It still settles from the time before.
    ASSERT_NEAR(again, readings.all[3 * k], 1e-5) << k;
  }
  EXPECT_GT(largest, 3.9e-3);
}

TEST(RunningMachine, RepeatsNoMotionThatEndsElsewhere) {
  const Machine machine = test::Bonder({"trajectories.multi.duration=0.025"});
  RunOptions options;
  options.repeat = true;
  EXPECT_THAT(test::MessageOf<InputError>([&] {
                StartLinear(machine, DefaultMotion(machine.setup()), options);
              }),
              HasSubstr("does not end at rest where it begins"));
}

}  // namespace
}  // namespace mjdiag
