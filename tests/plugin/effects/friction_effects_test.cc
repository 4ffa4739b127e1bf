// Friction and hysteresis against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using test::EffectBench;

constexpr double kMass = EffectBench::kMass;

// v(t) of m dv/dt = -f(v), by Runge-Kutta with steps of 1 us.
template <typename Friction>
double SpeedAfter(double speed, double time, const Friction& friction) {
  const double h = 1e-6;
  for (double t = 0.0; t < time - 0.5 * h; t += h) {
    const auto slope = [&](double v) { return -friction(v) / kMass; };
    const double a = slope(speed);
    const double b = slope(speed + 0.5 * h * a);
    const double c = slope(speed + 0.5 * h * b);
    speed += h / 6.0 * (a + 2.0 * b + 2.0 * c + slope(speed + h * c));
  }
  return speed;
}

// 3 N and 5 N more at rest: from 0.05 m/s the block stands after about 25 ms.
TEST(FrictionEffects, StribeckFrictionGrowsAsTheBlockSlowsDown) {
  const auto friction = [](double v) {
    return 3.0 + 5.0 * std::exp(-v * v / (0.02 * 0.02));
  };
  for (const double direction : {1.0, -1.0}) {
    EffectBench bench({"stribeck_friction@q:coulomb=3,breakaway=5,velocity=0.02"});
    bench.v() = direction * 0.05;
    for (const double time : {0.005, 0.010, 0.015, 0.020}) {
      bench.StepUntil(time);
      // A step of the first-order integrator changes v by up to 4e-4.
      EXPECT_NEAR(direction * bench.v(), SpeedAfter(0.05, time, friction), 2e-4);
    }
  }
}

// What sticks creeps with (1 - d) / d F / (m b), d = 0.99 the impedance and
// b = 1e4 / s the damping of the constraint: 4e-6 m/s under 8 N.
constexpr double kCreep = 3e-6;  // in half a second, with a margin [m]

TEST(FrictionEffects, StribeckFrictionHoldsUpToTheSumAtRest) {
  EffectBench bench({"stribeck_friction@q:coulomb=3,breakaway=5,velocity=0.02"});
  bench.StepUntil(0.5, 7.9);
  EXPECT_LT(std::abs(bench.q()), kCreep);
  bench.StepUntil(1.0, 8.1);
  EXPECT_GT(bench.q(), 0.01);
}

TEST(FrictionEffects, StribeckFrictionWithoutAConstantPartHoldsAsWell) {
  EffectBench bench({"stribeck_friction@q:coulomb=0,breakaway=5,velocity=0.02"});
  bench.StepUntil(0.5, 4.9);
  EXPECT_LT(std::abs(bench.q()), kCreep);
}

/// Where 4 N have pushed a joint that rubs with 8 N after half a second.
double PushedTo(const char* effect, const std::string& joint = R"(type="slide")") {
  EffectBench bench({effect}, joint);
  bench.StepUntil(0.5, 4.0);
  return bench.q();
}

// d = 0.9 and b = 2 / (0.95 * 0.02 s) by MuJoCo's defaults.
TEST(FrictionEffects, YieldingFrictionGivesWayAtRestAsMuJoCosDoes) {
  const double speed = 0.1 / 0.9 * 4.0 / (kMass * 2.0 / (0.95 * 0.02));
  EXPECT_NEAR(PushedTo("yielding_friction@q:force=8"), 0.5 * speed, 0.05 * 0.5 * speed);
  EXPECT_LT(std::abs(PushedTo("coulomb_friction@q:force=8")), kCreep);
}

TEST(FrictionEffects, CoulombFrictionSticksAsTheModelSaysWhereItSaysHow) {
  const std::string soft = R"(type="slide" solreffriction="0.03 1")";
  EXPECT_EQ(PushedTo("coulomb_friction@q:force=8", soft),
            PushedTo("yielding_friction@q:force=8", soft));
}

TEST(FrictionEffects, ViscousFrictionAddsToTheDampingThatThereIs) {
  EffectBench bench({"viscous_friction@q:coefficient=3"},
                    R"(type="slide" damping="1")");
  bench.v() = 0.3;
  bench.StepUntil(0.5);
  EXPECT_NEAR(bench.v(), 0.3 * std::exp(-4.0 / kMass * 0.5), 1e-4 * 0.3);
}

TEST(FrictionEffects, AsymmetricViscousFrictionHasACoefficientForEachDirection) {
  for (const double direction : {1.0, -1.0}) {
    EffectBench bench({"asymmetric_viscous_friction@q:positive=3,negative=7"});
    bench.v() = direction * 0.3;
    bench.StepUntil(0.5);
    const double coefficient = direction > 0.0 ? 3.0 : 7.0;
    EXPECT_NEAR(bench.v(), direction * 0.3 * std::exp(-coefficient / kMass * 0.5),
                2e-4 * 0.3);
  }
}

// m dv/dt = -c v^2 gives 1 / v = 1 / v0 + c t / m.
TEST(FrictionEffects, QuadraticDragSlowsDownHyperbolically) {
  for (const double direction : {1.0, -1.0}) {
    EffectBench bench({"quadratic_drag@q:coefficient=5"});
    bench.v() = direction * 2.0;
    bench.StepUntil(0.5);
    EXPECT_NEAR(direction * bench.v(), 1.0 / (0.5 + 5.0 * 0.5 / kMass), 5e-4);
  }
}

/// A period of q = amplitude sin(2 pi t / T) and the force over it.
struct Loop {
  double area = 0.0;    ///< energy lost [J]
  double at_end = 0.0;  ///< force at the largest position [N]
};

/// Drives the joint until what it remembers of the start has decayed by exp(-12), for
/// an amplitude of a tenth of the memory's length.
Loop DriveToAndFro(EffectBench& bench, double amplitude) {
  constexpr int kSteps = 4000;
  constexpr int kPeriods = 31;
  Loop loop;
  double position = 0.0;
  double force = 0.0;
  for (int k = 1; k <= kPeriods * kSteps; ++k) {
    const double next = amplitude * std::sin(2.0 * std::numbers::pi * k / kSteps);
    const double next_force =
        bench.ForceAt(next, (next - position) / EffectBench::kStep);
    const int in_last_period = k - (kPeriods - 1) * kSteps;
    if (in_last_period > 0) {
      loop.area -= 0.5 * (force + next_force) * (next - position);
    }
    if (in_last_period == kSteps / 4) loop.at_end = next_force;
    position = next;
    force = next_force;
  }
  return loop;
}

// In a steady cycle of amplitude A the memory z runs between +-L tanh(A / L), and the
// loop of z over q has the area 4 L (A - L tanh(A / L)).
TEST(FrictionEffects, PreslidingHysteresisLosesTheEnergyOfDahlsLoop) {
  const double force = 3.0;
  const double stiffness = 1e4;
  const double length = force / stiffness;
  for (const double amplitude : {0.1 * length, length, 20.0 * length}) {
    EffectBench bench({"presliding_hysteresis@q:force=3,stiffness=1e4"});
    const Loop loop = DriveToAndFro(bench, amplitude);
    const double z = length * std::tanh(amplitude / length);
    EXPECT_NEAR(loop.area, 4.0 * force * (amplitude - z),
                1e-3 * 4.0 * force * (amplitude - z));
    EXPECT_NEAR(loop.at_end, -stiffness * z, 1e-3 * force);
  }
}

TEST(FrictionEffects, PreslidingHysteresisIsASpringBeforeItSlides) {
  EffectBench bench({"presliding_hysteresis@q:force=3,stiffness=1e4"});
  bench.v() = 1e-4;
  bench.StepUntil(0.01);
  // sqrt(stiffness / m) is 70.7 rad/s.
  const double omega = std::sqrt(1e4 / kMass);
  EXPECT_NEAR(bench.v(), 1e-4 * std::cos(omega * 0.01), 1e-6);
}

TEST(FrictionEffects, HystereticStiffnessIsASpringWithDahlsLoop) {
  const double stiffness = 500.0;
  const double loss = 0.4;
  const double length = 1e-3;
  for (const double amplitude : {0.5e-3, 5e-3}) {
    EffectBench bench({"hysteretic_stiffness@q:stiffness=500,loss=0.4,length=1e-3"});
    const Loop loop = DriveToAndFro(bench, amplitude);
    const double z = length * std::tanh(amplitude / length);
    const double area = 4.0 * stiffness * loss * length * (amplitude - z);
    EXPECT_NEAR(loop.area, area, 1e-3 * area);
    EXPECT_NEAR(loop.at_end, -stiffness * (amplitude + loss * z),
                1e-3 * stiffness * amplitude);
  }
}

}  // namespace
}  // namespace mjdiag
