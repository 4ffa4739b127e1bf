// What happens between command and force, against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using test::EffectBench;

constexpr double kMass = EffectBench::kMass;
constexpr double kStep = EffectBench::kStep;

TEST(DriveEffects, ForceOffsetAcceleratesByForceOverMass) {
  EffectBench bench({"force_offset@q:force=-3"});
  bench.StepUntil(0.2);
  EXPECT_NEAR(bench.v(), -3.0 / kMass * 0.2, 1e-12);
}

// The ripple is conservative: its work between two positions is
// amplitude period / (2 pi) (cos(phase) - cos(2 pi q / period + phase)).
TEST(DriveEffects, ForceRippleDoesTheWorkOfItsPotential) {
  const double period = 0.01;
  const double wave_number = 2.0 * std::numbers::pi / period;
  EffectBench bench({"force_ripple@q:amplitude=4,period=0.01,phase=0.5"});
  bench.v() = 0.2;
  for (double time = 0.005; time < 0.2; time += 0.005) {
    bench.StepUntil(time);
    const double work =
        4.0 / wave_number * (std::cos(0.5) - std::cos(wave_number * bench.q() + 0.5));
    const double energy = 0.5 * kMass * (bench.v() * bench.v() - 0.2 * 0.2);
    // v changes by up to 2e-4 within a step.
    EXPECT_NEAR(energy, work, kMass * 0.2 * 2e-4);
  }
}

// At qpos0, wherever the joint has its zero.
TEST(DriveEffects, ForceRippleCountsFromTheRestPosition) {
  EffectBench bench({"force_ripple@q:amplitude=4,period=0.01"},
                    R"(type="slide" ref="0.303")");
  EXPECT_NEAR(bench.ForceAt(0.303, 0.0), 0.0, 1e-12);
  EXPECT_NEAR(bench.ForceAt(0.3055, 0.0), 4.0, 1e-9);
}

TEST(DriveEffects, MotorConstantScalesTheForce) {
  EffectBench bench({"motor_constant@motor:factor=0.9"}, "type=\"slide\"",
                    "gear=\"5\"");
  bench.StepUntil(0.1, 2.0);
  EXPECT_NEAR(bench.v(), 0.9 * 5.0 * 2.0 / kMass * 0.1, 1e-12);
}

TEST(DriveEffects, PositionDependentMotorConstantFollowsTheTravelOfTheMotor) {
  EffectBench bench({"position_dependent_motor_constant@motor:slope=2,curvature=-30"},
                    R"(type="slide" ref="0.3")", "gear=\"5\"");
  for (const double s : {-0.1, 0.0, 0.02, 0.2}) {
    EXPECT_NEAR(bench.ForceAt(0.3 + s, 0.0, 7.0), 35.0 * (1.0 + 2.0 * s - 30.0 * s * s),
                1e-12);
  }
}

TEST(DriveEffects, ForceSaturationLimitsTheDriveInBothDirections) {
  EffectBench bench({"force_saturation@motor:limit=2"}, "type=\"slide\"", "gear=\"5\"");
  EXPECT_DOUBLE_EQ(bench.ForceAt(0.0, 0.0, 1.9), 9.5);
  EXPECT_DOUBLE_EQ(bench.ForceAt(0.0, 0.0, 70.0), 10.0);
  EXPECT_DOUBLE_EQ(bench.ForceAt(0.0, 0.0, -70.0), -10.0);
}

TEST(DriveEffects, ForceSaturationKeepsANarrowerLimit) {
  EffectBench bench({"force_saturation@motor:limit=2"}, "type=\"slide\"",
                    R"(forcelimited="true" forcerange="-1 3")");
  EXPECT_DOUBLE_EQ(bench.ForceAt(0.0, 0.0, 70.0), 2.0);
  EXPECT_DOUBLE_EQ(bench.ForceAt(0.0, 0.0, -70.0), -1.0);
}

// A ramp shows the delay, whole steps or not, without error.
TEST(DriveEffects, InputDelayIsExactForFractionsOfAStep) {
  for (const double steps : {0.0, 0.3, 1.0, 2.5, 17.25}) {
    EffectBench bench(
        {"input_delay@motor:delay=" + std::to_string(steps * kStep * 1e4) + "e-4"});
    for (int k = 0; k < 40; ++k) {
      const double force = bench.ForceAt(0.0, 0.0, 3.0 * k);
      if (k <= steps + 1.0) continue;
      EXPECT_NEAR(force, 3.0 * (k - steps), 1e-9) << steps << " steps, " << k;
    }
  }
}

TEST(DriveEffects, InputDelayBeginsWithTheFirstCommand) {
  EffectBench bench({"input_delay@motor:delay=0.00123"});
  EXPECT_EQ(bench.ForceAt(0.0, 0.0, 4.0), 4.0);
}

// A step of u loses the impulse u delay, whatever the delay is.
TEST(DriveEffects, InputDelayLosesTheImpulseOfTheDelay) {
  EffectBench bench({"input_delay@motor:delay=0.00123"});
  bench.Step(0.0);
  const double start = bench.time();
  bench.StepUntil(start + 0.05, 4.0);
  EXPECT_NEAR(kMass * bench.v(), 4.0 * (0.05 - 0.00123), 1e-12);
}

// f = 1 - exp(-t / T); its integral is t - T (1 - exp(-t / T)).
TEST(DriveEffects, AmplifierLagHasTheStepResponseOfALowPass) {
  const double lag = 0.0023;
  EffectBench bench({"amplifier_lag@motor:time_constant=0.0023"});
  bench.Step(0.0);
  const double start = bench.time();
  for (const double t : {0.0005, 0.002, 0.01, 0.05}) {
    bench.StepUntil(start + t, 4.0);
    EXPECT_NEAR(kMass * bench.v(), 4.0 * (t + lag * std::expm1(-t / lag)), 1e-12);
  }
}

}  // namespace
}  // namespace mjdiag
