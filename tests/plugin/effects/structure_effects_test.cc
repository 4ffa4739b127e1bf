// Springs, masses, stops and vibration against closed forms.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using test::EffectBench;

constexpr double kMass = EffectBench::kMass;
constexpr double kStep = EffectBench::kStep;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// Period of the swing from rest at `position` [s]: twice the time until it stands
/// again.
double Period(EffectBench& bench, double position) {
  bench.q() = position;
  bench.Step();
  const double direction = bench.v();
  double before = direction;
  while (bench.v() * direction > 0.0) {
    before = bench.v();
    bench.Step();
  }
  // Where v crosses zero between the two last steps.
  return 2.0 * (bench.time() - kStep * bench.v() / (bench.v() - before));
}

TEST(QuadraticStiffness, PushesTheSameWayOnBothSides) {
  test::EffectBench bench({"quadratic_stiffness@q:coefficient=300"});
  EXPECT_NEAR(bench.ForceAt(0.02, 0.0), -300.0 * 4e-4, 1e-12);
  EXPECT_NEAR(bench.ForceAt(-0.02, 0.0), -300.0 * 4e-4, 1e-12);
}

TEST(StructureEffects, LinearStiffnessSwingsAboutTheRestPosition) {
  EffectBench bench({"linear_stiffness@q:stiffness=800"}, R"(type="slide" ref="0.3")");
  EXPECT_NEAR(Period(bench, 0.31), kTurn * std::sqrt(kMass / 800.0), 1e-5);
  EXPECT_NEAR(bench.q(), 0.29, 1e-5);
}

// 300 N/m that pull to 0.2 and 100 N/m to 0.
TEST(StructureEffects, LinearStiffnessIsASecondSpringBesideAPreloadedOne) {
  EffectBench bench({"linear_stiffness@q:stiffness=100"},
                    R"(type="slide" stiffness="300" springref="0.2")");
  for (const double q : {-0.1, 0.0, 0.15, 0.4}) {
    EXPECT_NEAR(bench.ForceAt(q, 0.0), -300.0 * (q - 0.2) - 100.0 * q, 1e-10);
  }
}

TEST(StructureEffects, StructuralStiffnessScalesTheSpring) {
  EffectBench bench({"structural_stiffness@q:factor=0.64"},
                    R"(type="slide" stiffness="800" springref="0.01")");
  EXPECT_NEAR(Period(bench, 0.0), kTurn * std::sqrt(kMass / (0.64 * 800.0)), 1e-5);
}

// The period of a purely cubic spring from rest at A is 4 K sqrt(m / c) / A with
// K = integral of sqrt(2 / (1 - s^4)) over [0, 1] = 1.8540746773.
TEST(StructureEffects, CubicStiffnessSwingsSlowerTheSmallerTheSwing) {
  for (const double amplitude : {0.1, 0.05}) {
    EffectBench bench({"cubic_stiffness@q:coefficient=4e4"});
    EXPECT_NEAR(Period(bench, amplitude),
                4.0 * 1.8540746773 * std::sqrt(kMass / 4e4) / amplitude, 1e-5);
  }
}

TEST(StructureEffects, AddedMassAcceleratesByForceOverTheSum) {
  for (const double mass : {0.5, -0.5}) {
    EffectBench bench({"added_mass@q:mass=" + std::to_string(mass)});
    bench.StepUntil(0.1, 3.0);
    EXPECT_NEAR(bench.v(), 3.0 / (kMass + mass) * 0.1, 1e-12);
  }
}

TEST(StructureEffects, AddedMassIsInertiaAboutAHinge) {
  EffectBench bench({"added_mass@q:mass=0.5"}, "type=\"hinge\"");
  bench.StepUntil(0.1, 3.0);
  EXPECT_NEAR(bench.v(), 3.0 / (kMass + 0.5) * 0.1, 1e-12);
}

TEST(StructureEffects, AddedMassHasWeight) {
  EffectBench bench({"added_mass@q:mass=0.5"}, R"(type="slide" axis="0 0 1")");
  bench.model().opt.gravity[2] = -10.0;
  bench.StepUntil(0.1, 10.0 * (kMass + 0.5));
  EXPECT_NEAR(bench.v(), 0.0, 1e-12);
}

// Joint m under a constant force F with a mass m2 at frequency w on it: x - q swings at
// W = w sqrt(1 + m2 / m) about -F / (m W^2), the centre of mass accelerates by
// F / (m + m2).
TEST(StructureEffects, FlexibleModeSwingsAtTheFrequencyOfTheCoupledSystem) {
  const double mode_mass = 0.5;
  EffectBench bench({"flexible_mode@q:mass=0.5,frequency=40,damping_ratio=0"});
  const double omega = kTurn * 40.0 * std::sqrt(1.0 + mode_mass / kMass);
  const double swing = 6.0 / kMass / (omega * omega);
  const double share = mode_mass / (kMass + mode_mass);
  for (double t = 0.001; t < 0.2; t += 0.001) {
    bench.StepUntil(t, 6.0);
    const double together = 6.0 / (kMass + mode_mass) * t;
    const double apart = swing * omega * std::sin(omega * t);
    // Nine periods of about 224 steps each: the phase is off by (w h)^2 / 24 a step.
    EXPECT_NEAR(bench.v(), together + share * apart, 0.02 * share * swing * omega) << t;
  }
}

TEST(StructureEffects, FlexibleModeIsAMassOnceItHasSwungOut) {
  EffectBench bench({"flexible_mode@q:mass=0.5,frequency=40,damping_ratio=0.3"});
  bench.StepUntil(0.3, 6.0);
  const double before = bench.v();
  bench.StepUntil(0.4, 6.0);
  EXPECT_NEAR((bench.v() - before) / 0.1, 6.0 / (kMass + 0.5), 1e-6);
}

// Free swing of the mode decays with exp(-zeta' W t); zeta' W = zeta w (1 + m2 / m).
TEST(StructureEffects, FlexibleModeDecaysWithItsDampingRatio) {
  EffectBench bench({"flexible_mode@q:mass=0.5,frequency=40,damping_ratio=0.02"});
  const double ratio = 1.0 + 0.5 / kMass;
  const double decay = 0.02 * kTurn * 40.0 * ratio;
  const double omega = std::sqrt(std::pow(kTurn * 40.0, 2) * ratio - decay * decay);
  // Deviation from the common motion, at its largest after a push of one step.
  const auto largest = [&](double from, double to) {
    double deviation = 0.0;
    while (bench.time() < to) {
      bench.Step();
      const double common = 6.0 * kStep / (kMass + 0.5);
      if (bench.time() > from)
        deviation = std::max(deviation, std::abs(bench.v() - common));
    }
    return deviation;
  };
  bench.Step(0.0);
  bench.Step(6.0);
  const double period = kTurn / omega;
  const double first = largest(0.01, 0.01 + period);
  const double later = largest(0.01 + 5.0 * period, 0.01 + 6.0 * period);
  EXPECT_NEAR(later / first, std::exp(-decay * 5.0 * period), 0.01);
}

TEST(StructureEffects, BacklashTakesTheSpringAwayWithinItsGap) {
  EffectBench bench({"backlash@q:gap=0.002"},
                    R"(type="slide" stiffness="800" springref="0.1")");
  for (const double strain : {-0.003, -0.001, -0.0004, 0.0, 0.0009, 0.001, 0.005}) {
    const double beyond = std::max(0.0, std::abs(strain) - 0.001);
    EXPECT_NEAR(bench.ForceAt(0.1 + strain, 0.0),
                -800.0 * std::copysign(beyond, strain), 1e-10);
  }
}

// Contact lasts half a period of the mass on the spring of the stop.
TEST(StructureEffects, EndStopThrowsTheMassBackAndLeavesItAlone) {
  for (const double side : {1.0, -1.0}) {
    EffectBench bench(
        {"end_stop@q:position=" + std::to_string(side * 0.01) + ",stiffness=2e4"});
    bench.v() = side * 0.1;
    bench.StepUntil(0.09);
    EXPECT_EQ(bench.v(), side * 0.1);
    const double contact = std::numbers::pi * std::sqrt(kMass / 2e4);
    bench.StepUntil(0.1 + 0.5 * contact);
    EXPECT_NEAR(bench.v(), 0.0, 0.1 * 0.02);
    bench.StepUntil(0.1 + contact + 0.01);
    EXPECT_NEAR(bench.v(), -side * 0.1, 0.1 * 0.01);
  }
}

// A stop at zero holds the positive side.
TEST(StructureEffects, EndStopAtZeroHoldsThePositiveSide) {
  EffectBench bench({"end_stop@q:position=0,stiffness=2e4"});
  EXPECT_EQ(bench.ForceAt(-0.001, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(bench.ForceAt(0.001, 0.0), -20.0);
}

TEST(StructureEffects, FloorVibrationShakesWithItsPhase) {
  EffectBench bench({"floor_vibration@q:amplitude=5,frequency=30,phase=0.4"});
  const double omega = kTurn * 30.0;
  for (double t = 0.01; t < 0.2; t += 0.01) {
    bench.StepUntil(t);
    const double speed = 5.0 / (kMass * omega);
    EXPECT_NEAR(bench.v(), speed * (std::cos(0.4) - std::cos(omega * t + 0.4)),
                0.02 * speed);
  }
}

}  // namespace
}  // namespace mjdiag
