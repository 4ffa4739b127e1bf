// Values are those of a motion, not those of what is quick in it.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "mjdiag/discovery/discovery.h"
#include "support/any_machine.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kTick = 0.005;    // s
constexpr double kMass = 2.0;      // kg
constexpr double kViscous = 10.0;  // N s/m
constexpr double kQuick = 30.0;    // N s/m, of what is quicker than
constexpr double kRate = 30.0;     // 1/s
constexpr double kMissing = 1.5;   // N, rms
constexpr double kLasts = 1.5;     // s

Machine Carriage() {
  return test::MachineOf(
      R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="j" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.1"/></body></worldbody>
      <actuator><motor name="u" joint="j"/></actuator>
      <sensor><jointpos name="y" joint="j"/></sensor></mujoco>)",
      "[rates]\ncontrol = 200.0\nsubsteps = 5\n[sensors.y]\nelement = \"y\"\n"
      "unit = \"m\"\n[actuators.u]\nelement = \"u\"\nunit = \"N\"\n");
}

/// A carriage that rubs more in what is quick, on a spring of a viscous damper and a force that
/// nobody knows: slow strokes and a little rattling. In steps of 100 us.
Record Measured() {
  constexpr Index kSamples = 6000;
  constexpr int kSteps = 50;
  constexpr double dt = kTick / kSteps;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  struct Tone {
    double force, frequency, phase;
  };
  std::vector<Tone> tones;
  constexpr std::array<std::array<double, 2>, 4> kStrokes{
      {{12.0, 0.2}, {9.0, 0.35}, {7.0, 0.6}, {5.0, 0.9}}};
  for (const auto& [force, frequency] : kStrokes)
    tones.push_back({force, frequency, phase(random)});
  for (double frequency = 3.0; frequency < 20.0; frequency += 0.07) {
    tones.push_back({0.136, frequency, phase(random)});
  }
  VectorXd y(kSamples), u(kSamples);
  double x = 0.0, v = 0.0, slow_v = 0.0, missing = 0.0;
  const double rho = std::exp(-kTick / kLasts);
  for (Index k = 0; k < kSamples; ++k) {
    const double t = static_cast<double>(k) * kTick;
    u[k] = 0.0;
    for (const Tone& one : tones) {
      u[k] +=
          one.force * std::sin(2.0 * std::numbers::pi * one.frequency * t + one.phase);
    }
    y[k] = x + 1e-6 * normal(random);
    missing = rho * missing + std::sqrt(1.0 - rho * rho) * kMissing * normal(random);
    for (int i = 0; i < kSteps; ++i) {
      const double f = u[k] + missing - kViscous * v - kQuick * (v - slow_v);
      v += dt * f / kMass;
      x += dt * v;
      slow_v += dt * kRate * (v - slow_v);
    }
  }
  Record record(kTick);
  record.Add({"y", "m", y});
  record.Add({"u", "N", u});
  return record;
}

TEST(SlowValues, OfALawThatIsWrongInWhatIsQuickAreThoseOfTheStrokes) {
  DiscoverOptions options;
  options.choice.only = {"viscous_friction"};
  options.figures = false;
  const Discovery answer = Discover(Carriage(), Measured(), nullptr, options);
  ASSERT_EQ(answer.causes.size(), 1u);
  const CauseParameter& found = answer.causes[0].parameters[0];
  // What is quick adds kQuick (2 pi f / kRate)^2 at f: 0.3 N s/m by the strokes' velocities.
  constexpr double kOfStrokes = kViscous + 0.3;
  EXPECT_NEAR(found.value, kOfStrokes, 0.7);
  EXPECT_LT(found.low, kOfStrokes);
  EXPECT_GT(found.high, kOfStrokes);
}

}  // namespace
}  // namespace mjdiag
