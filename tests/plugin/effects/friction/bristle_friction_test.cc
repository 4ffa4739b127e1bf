// LuGre friction and the presliding friction of gears against closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/effects/registry.h"
#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using test::EffectBench;

constexpr double kStep = EffectBench::kStep;

/// The force after the joint has moved from rest at v for a time, under a command.
double ForceAfter(EffectBench& bench, double v, double time, double command = 0.0) {
  double force = 0.0;
  double q = bench.q();
  for (double t = 0.5 * kStep; t < time; t += kStep) {
    q += v * kStep;
    force = bench.ForceAt(q, v, command);
  }
  return force - command;
}

const char* const kLugre =
    "lugre_friction@q:coulomb=3,breakaway=2,velocity=0.01,stiffness=2000,damping=40";

TEST(LugreFriction, IsASpringAndADamperBeforeItSlides) {
  EffectBench bench({kLugre});
  const double v = 1e-6;
  // A five-thousandth of the way to sliding: z = v t, but for a ten-thousandth.
  const double time = 0.5;
  EXPECT_NEAR(ForceAfter(bench, v, time), -(2000.0 * v * time + 40.0 * v), 2e-4 * 1e-3);
}

TEST(LugreFriction, SlidesAlongStribecksCurve) {
  for (const double v : {0.002, -0.01, 0.05}) {
    EffectBench bench({kLugre});
    const double curve = 3.0 + 2.0 * std::exp(-std::pow(v / 0.01, 2));
    EXPECT_NEAR(ForceAfter(bench, v, 0.06 / std::abs(v)), -std::copysign(curve, v),
                1e-6);
  }
}

// z = (1 - exp(-stiffness x / g)) g / stiffness after the way x.
TEST(LugreFriction, GoesToSlidingOnAnExponentialOfItsWay) {
  EffectBench bench(
      {"lugre_friction@q:coulomb=3,breakaway=0,velocity=1,stiffness=2000,"
       "damping=0"});
  EXPECT_NEAR(ForceAfter(bench, 0.1, 0.02), -3.0 * -std::expm1(-2000.0 * 0.002 / 3.0),
              1e-9);
}

// Bristles of an explicit step that resolves neither would throw the joint about.
TEST(LugreFriction, HoldsWithBristlesStifferThanTheStep) {
  EffectBench bench(
      {"lugre_friction@q:coulomb=3,breakaway=1,velocity=0.01,"
       "stiffness=1e14,damping=1e9"});
  bench.v() = 0.3;
  bench.StepUntil(0.3);
  EXPECT_NEAR(bench.v(), 0.0, 4.0 / EffectBench::kMass * kStep);
  const double stands = bench.q();
  // Stops after v^2 m / (2 F), and holds under less than it breaks away at.
  EXPECT_NEAR(stands, 0.3 * 0.3 * EffectBench::kMass / (2.0 * 3.0), 1e-3);
  bench.StepUntil(0.6, 2.5);
  EXPECT_NEAR(bench.q(), stands, 1e-6);
}

TEST(LugreFriction, IsStribeckFrictionWithoutBristles) {
  const auto simpler = LugreFriction().Simpler(ParseEffect(kLugre));
  ASSERT_TRUE(simpler);
  EXPECT_EQ(FormatEffect(*simpler),
            "stribeck_friction@q:coulomb=3,breakaway=2,velocity=0.01");
}

const char* const kGear =
    "presliding_gear_friction@q:driving=0.3,backdriving=0.1,length=0.002";

TEST(PreslidingGearFriction, TakesAShareOfWhatDrivesAndAnotherOfWhatIsDrivenBack) {
  for (const double direction : {1.0, -1.0}) {
    EffectBench driving({kGear});
    const double force = ForceAfter(driving, direction * 0.1, 0.5, direction * 20.0);
    EXPECT_NEAR(force, -direction * 0.3 * 20.0, 1e-6);
    EffectBench back({kGear});
    EXPECT_NEAR(ForceAfter(back, direction * 0.1, 0.5, -direction * 20.0),
                -direction * 0.1 * 20.0, 1e-6);
  }
}

TEST(PreslidingGearFriction, TurnsRoundOverItsLength) {
  EffectBench bench({kGear});
  const double z = -std::expm1(-0.001 / 0.002);
  EXPECT_NEAR(ForceAfter(bench, 0.1, 0.01, 20.0),
              -(0.2 * 20.0 * z + 0.1 * 20.0 * z * z), 1e-9);
}

TEST(PreslidingGearFriction, TakesNothingOfAMotorThatIsOff) {
  EffectBench bench({kGear});
  EXPECT_EQ(ForceAfter(bench, 0.1, 0.01), 0.0);
}

// Teeth that turn round within less than a step are dry friction of the drive.
TEST(PreslidingGearFriction, IsDryFrictionWithALengthBelowThatOfAStep) {
  EffectBench bench(
      {"presliding_gear_friction@q:driving=0.4,backdriving=1.2,length=1e-12"});
  bench.v() = -0.1;
  bench.StepUntil(0.015, 5.0);
  const double braked = -0.1 + 0.015 * 5.0 * 2.2 / EffectBench::kMass;
  EXPECT_NEAR(bench.v(), braked, 1e-3);
}

}  // namespace
}  // namespace mjdiag
