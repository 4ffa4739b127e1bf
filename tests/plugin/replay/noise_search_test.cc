#include "mjdiag/plugin/replay/noise_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/any_machine.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kTick = 1e-3;
constexpr double kNoise = 1e-6;  // [rad]
constexpr Index kSamples = 2000;

/// Two joints, both driven and read.
Machine TwoJoints() {
  return test::MachineOf(
      R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="a" axis="0 1 0" damping="0.4"/>
      <inertial pos="0.1 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
      <body pos="0.3 0 0"><joint name="b" axis="0 1 0" damping="0.1"/>
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body></body>
      </worldbody><actuator><motor name="u" joint="a"/><motor name="w" joint="b"/></actuator>
      <sensor><jointpos name="y" joint="a"/><jointpos name="z" joint="b"/></sensor></mujoco>)",
      "[rates]\ncontrol = 1000.0\n[sensors.y]\nelement = \"y\"\nunit = \"rad\"\n"
      "[sensors.z]\nelement = \"z\"\nunit = \"rad\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N m\"\n"
      "[actuators.w]\nelement = \"w\"\nunit = \"N m\"\n");
}

/// What it reads by a clock that is off by a quarter of a tick, the same for both, where dry
/// friction acts that the machine lacks.
MeasuredRun ReadAtTheWrongTime(const Machine& machine) {
  const VectorXd t = kTick * VectorXd::LinSpaced(kSamples, 0.0, kSamples - 1.0);
  Excitation excitation;
  excitation.inputs = Record(kTick);
  excitation.inputs.Add({"u", "N m", 20.0 * (9.0 * t.array()).sin()});
  excitation.inputs.Add({"w", "N m", 8.0 * (23.0 * t.array()).sin()});
  RunOptions options;
  options.noise_scale = 0.0;
  const Machine rubs = machine.With(
      test::With({"coulomb_friction@a:force=2", "coulomb_friction@b:force=0.5"}));
  MeasuredRun run = ToMeasuredRun(machine.setup(), Simulate(rubs, excitation, options));
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd exact = run.outputs;
  for (Index k = 0; k < kSamples; ++k) {
    const Index next = std::min(k + 1, kSamples - 1);
    const double late = 0.25 * normal(random);
    for (Index i = 0; i < 2; ++i) {
      run.outputs(i, k) +=
          late * (exact(i, next) - exact(i, std::max<Index>(0, next - 1))) +
          kNoise * normal(random);
    }
  }
  return run;
}

// The clock shows in what the search begins with, and stays in it.
TEST(NoiseSearch, GoesOnFromANoiseWithAClockThatShows) {
  const Machine machine = TwoJoints();
  const MeasuredRun run = ReadAtTheWrongTime(machine);
  const VectorXd sd = VectorXd::Constant(2, kNoise);
  const FilterPath likely = FilterLikeliest(machine, run, sd);
  EXPECT_NEAR(likely.noise.clock, 0.25 * kTick, 0.05 * kTick);
  FilterNoise near = likely.noise;
  near.white *= 1.5;
  near.clock *= 1.2;
  const FilterPath path =
      RunForceFilter(machine, run, likely.dofs, likely.starts, near);
  const LikelyNoise found = NoiseSearch(path, sd, 0.1).Descend(near, false);
  EXPECT_GE(found.gain, 0.0);
  EXPECT_NEAR(found.noise.clock, likely.noise.clock, 0.02 * kTick);
}

}  // namespace
}  // namespace mjdiag
