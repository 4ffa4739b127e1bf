// Friction that changes with the place, with time or with a history.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/effects/registry.h"
#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using test::EffectBench;

/// Force that brakes the bench at that place and speed from rest of all memories [N].
double Braking(const std::vector<std::string>& effects, double q, double v,
               double from = 0.0) {
  EffectBench bench(effects);
  bench.StepUntil(from);
  bench.q() = q;
  bench.v() = v;
  bench.Step();
  return (v - bench.v()) * EffectBench::kMass / EffectBench::kStep;
}

TEST(PositionDependentFriction, IsItsPolynomialOfThePosition) {
  const std::vector<std::string> effect{
      "position_dependent_friction@q:slope=3,curvature=20"};
  EXPECT_NEAR(Braking(effect, 0.1, 1.0), 0.3 + 0.2, 1e-3);
  EXPECT_NEAR(Braking(effect, 0.1, -1.0), -0.5, 1e-3);
  EXPECT_NEAR(Braking(effect, -0.5, 1.0), -1.5 + 5.0, 1e-3);
}

TEST(PositionDependentFriction, TakesOffNoMoreThanOtherFrictionHas) {
  const char* falling = "position_dependent_friction@q:slope=-3,curvature=0";
  EXPECT_NEAR(Braking({falling}, 0.1, 1.0), 0.0, 1e-6);
  EXPECT_NEAR(Braking({falling, "coulomb_friction@q:force=0.5"}, 0.1, 1.0), 0.2, 1e-3);
  EXPECT_NEAR(Braking({falling, "coulomb_friction@q:force=0.5"}, 0.3, 1.0), 0.0, 1e-6);
}

TEST(PositionDependentDamping, IsItsPolynomialTimesTheVelocity) {
  EffectBench bench({"position_dependent_damping@q:slope=3,curvature=20"},
                    R"(type="slide" damping="0.5")");
  EXPECT_NEAR(bench.ForceAt(0.1, 2.0), -(0.5 + 0.3 + 0.2) * 2.0, 1e-12);
  EXPECT_NEAR(bench.ForceAt(-0.1, 2.0), -(0.5 - 0.3 + 0.2) * 2.0, 1e-12);
}

// Each alone leaves some damping at -0.1 m, where the two take off more than there is.
TEST(PositionDependentDamping, DrivesNothingTogetherWithWhatElseTakesOffTheDamper) {
  EffectBench bench({"position_dependent_damping@q:slope=4,curvature=0",
                     "asymmetric_viscous_friction@q:positive=-0.3,negative=2"},
                    R"(type="slide" damping="0.5")");
  EXPECT_NEAR(bench.ForceAt(-0.1, 2.0), 0.0, 1e-12);
  EXPECT_NEAR(bench.ForceAt(-0.1, -2.0), (0.5 - 0.4 + 2.0) * 2.0, 1e-12);
}

TEST(WarmingFriction, GoesAwayWithItsTimeConstant) {
  const std::vector<std::string> effect{"warming_friction@q:force=2,time_constant=0.1"};
  EXPECT_NEAR(Braking(effect, 0.0, 1.0), 2.0, 1e-3);
  EXPECT_NEAR(Braking(effect, 0.0, 1.0, 0.1), 2.0 * std::exp(-1.0), 1e-3);
  EXPECT_NEAR(Braking(effect, 0.0, 1.0, 0.6), 2.0 * std::exp(-6.0), 1e-3);
}

TEST(SmoothCoulombFriction, CreepsAndIsWholeAboveItsVelocity) {
  EffectBench bench({"smooth_coulomb_friction@q:force=4,velocity=0.5"});
  EXPECT_NEAR(bench.ForceAt(0.0, 0.5), -4.0 * std::tanh(1.0), 1e-12);
  EXPECT_NEAR(bench.ForceAt(0.0, 1e-6), -8e-6, 1e-15);
  EXPECT_NEAR(bench.ForceAt(0.0, -50.0), 4.0, 1e-12);
}

TEST(EddyCurrentBrake, IsLargestAtItsVelocity) {
  EffectBench bench({"eddy_current_brake@q:coefficient=4,velocity=0.5"});
  EXPECT_NEAR(bench.ForceAt(0.0, 0.5), -4.0 * 0.5 / 2.0, 1e-12);
  EXPECT_NEAR(bench.ForceAt(0.0, 1e-6), -4e-6, 1e-15);
  EXPECT_NEAR(bench.ForceAt(0.0, -5.0), 4.0 * 5.0 / 101.0, 1e-12);
}

/// The force after the bench has gone through these places at a constant speed.
double AfterTravel(const std::string& effect, const std::vector<double>& places) {
  EffectBench bench({effect});
  double force = 0.0;
  double q = 0.0;
  for (const double to : places) {
    const double v = to > q ? 1.0 : -1.0;
    const auto steps = std::lround(std::abs(to - q) / EffectBench::kStep);
    for (long i = 0; i < steps; ++i) {
      q += v * EffectBench::kStep;
      force = bench.ForceAt(q, v);
    }
  }
  return force;
}

// z = stiffness / rate (1 - exp(-rate q)) going up from rest, rate = loss + hardening.
TEST(BoucWen, FollowsItsClosedFormForAnExponentOfOne) {
  const std::string effect = "bouc_wen@q:stiffness=50,loss=8,hardening=4,exponent=1";
  const double up = 50.0 / 12.0 * (1.0 - std::exp(-12.0 * 0.05));
  EXPECT_NEAR(AfterTravel(effect, {0.05}), -up, 1e-6);
  // And down again at the rate hardening - loss, until z changes its sign:
  // dz/dx = -stiffness - (loss - hardening) z over the way x back.
  const double away = 50.0 / 4.0;
  const double down = (up + away) * std::exp(-4.0 * 0.02) - away;
  EXPECT_NEAR(AfterTravel(effect, {0.05, 0.03}), -down, 1e-6);
}

TEST(BoucWen, GrowsStifferWithANegativeHardeningBeyondItsLoss) {
  const std::string effect = "bouc_wen@q:stiffness=50,loss=8,hardening=-11,exponent=1";
  const double expected = 50.0 / 3.0 * (std::exp(3.0 * 0.1) - 1.0);
  EXPECT_NEAR(AfterTravel(effect, {0.1}), -expected, 1e-6);
}

TEST(BoucWen, SaturatesWhereItsPowerLawSays) {
  // stiffness = (loss + hardening) z^3
  const double z = std::cbrt(50.0 / 12.0);
  EXPECT_NEAR(
      AfterTravel("bouc_wen@q:stiffness=50,loss=8,hardening=4,exponent=3", {2.0}), -z,
      1e-4);
}

TEST(BoucWen, IsDahlFrictionWithoutHardening) {
  const PlacedEffect hysteresis =
      ParseEffect("bouc_wen@q:stiffness=50,loss=8,hardening=0");
  const auto simpler = BoucWen().Simpler(hysteresis);
  ASSERT_TRUE(simpler);
  const std::vector<double> way{0.07, 0.02, 0.05};
  EXPECT_NEAR(AfterTravel(FormatEffect(hysteresis), way),
              AfterTravel(FormatEffect(*simpler), way), 1e-6);
}

}  // namespace
}  // namespace mjdiag
