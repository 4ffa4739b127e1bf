#include "mjdiag/plugin/replay/noise_slope.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mjdiag/plugin/replay/linear_pass.h"
#include "support/any_machine.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Two masses on one another, both pushed, one read by an encoder and one by an
/// accelerometer, which reads at the end of a tick.
Machine TwoSlides() {
  return test::MachineOf(
      R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="a" type="slide" axis="1 0 0" damping="4"/>
      <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/><body>
      <joint name="b" type="slide" axis="1 0 0" damping="2" stiffness="500"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="s"/></body></body>
      </worldbody>
      <actuator><motor name="u" joint="a"/><motor name="w" joint="b"/></actuator>
      <sensor><jointpos name="y" joint="a"/><accelerometer name="z" site="s"/></sensor>
      </mujoco>)",
      "[rates]\ncontrol = 1000.0\n[sensors.y]\nelement = \"y\"\nunit = \"m\"\n"
      "[sensors.z]\nelement = \"z\"\nunit = \"m/s^2\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N\"\n"
      "[actuators.w]\nelement = \"w\"\nunit = \"N\"\n");
}

/// @param outliers  readings that are far off, which Huber's corner cuts
MeasuredRun Readings(Index samples, int outliers) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  MeasuredRun run;
  run.sample_time = 1e-3;
  run.inputs.resize(2, samples);
  run.outputs.resize(2, samples);
  for (Index k = 0; k < samples; ++k) {
    const double t = 1e-3 * static_cast<double>(k);
    run.inputs.col(k) << 8.0 * std::sin(9.0 * t), 3.0 * std::sin(31.0 * t);
    run.outputs.col(k) << 0.05 * std::sin(9.0 * t) + 1e-4 * normal(random),
        3.0 * std::sin(9.0 * t + 1.0) + 0.1 * normal(random);
    if (outliers > 0 && k % (samples / outliers) == 7) run.outputs(0, k) += 0.01;
  }
  return run;
}

FilterNoise Noise() {
  FilterNoise noise;
  noise.reading = VectorXd(2);
  noise.reading << 1.5e-4, 0.2;
  noise.clock = 2e-4;
  noise.clock_memory = 3e-3;
  noise.size = VectorXd(2);
  noise.size << 4.0, 2.0;
  noise.memory = VectorXd(2);
  noise.memory << 0.05, 0.2;
  noise.white = VectorXd(2);
  noise.white << 0.7, 0.3;
  return noise;
}

VectorXd LogarithmsOf(const FilterNoise& noise) {
  VectorXd x(10);
  x << noise.size, noise.memory, noise.white, noise.reading, noise.clock,
      noise.clock_memory;
  return x.array().log();
}

FilterNoise NoiseOf(const VectorXd& x) {
  const VectorXd e = x.array().exp();
  return {e.segment(6, 2), e[8], e[9], e.head(2), e.segment(2, 2), e.segment(4, 2)};
}

// Against central differences of the filter itself, in every noise; readings that are cut
// among them, behind another noise than that of the path.
TEST(NoiseSlope, IsTheDerivativeOfTheLikelihoodByEveryNoise) {
  const Machine machine = TwoSlides();
  for (const int outliers : {0, 5}) {
    const MeasuredRun run = Readings(400, outliers);
    const VectorXd sd = Noise().reading;
    const std::vector<Index> dofs{0, 1};
    FilterNoise of_path = Noise();
    of_path.memory *= 1.7;
    of_path.size *= 0.6;
    const FilterPath path =
        RunForceFilter(machine, run, dofs, FilterStarts(machine, run, sd), of_path);
    const NoiseSlope slope = SlopeAlong(path, Noise(), 0, 400);
    const VectorXd x = LogarithmsOf(Noise());
    ASSERT_EQ(slope.slope.size(), x.size());
    const auto deviance = [&](const VectorXd& at) {
      return Score(path, NoiseOf(at), 0, 400).deviance.sum();
    };
    EXPECT_NEAR(slope.deviance, deviance(x), 1e-9 * std::abs(slope.deviance));
    EXPECT_LT((slope.parts.rowwise().sum() - slope.slope).norm(),
              1e-9 * slope.slope.norm());
    for (Index i = 0; i < x.size(); ++i) {
      constexpr double kStep = 1e-4;
      const VectorXd step = kStep * VectorXd::Unit(x.size(), i);
      const double expected = (deviance(x + step) - deviance(x - step)) / (2.0 * kStep);
      EXPECT_NEAR(slope.slope[i], expected, 1e-5 * std::abs(expected) + 1e-4)
          << "noise " << i << ", outliers " << outliers;
    }
  }
}

/// Two links that stand upright, one on the other: what they are off by grows fivefold in 0.3 s.
Machine Upright() {
  return test::MachineOf(
      R"(<mujoco><option timestep="0.01"/><worldbody><body>
      <joint name="a" type="hinge" axis="0 1 0" damping="0.01"/>
      <inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.01"/><body pos="0 0 0.2">
      <joint name="b" type="hinge" axis="0 1 0" damping="0.01"/>
      <inertial pos="0 0 0.1" mass="0.5" diaginertia="0.01 0.01 0.01"/></body></body>
      </worldbody>
      <actuator><motor name="u" joint="a"/><motor name="w" joint="b"/></actuator>
      <sensor><jointpos name="y" joint="a"/><jointpos name="z" joint="b"/></sensor>
      </mujoco>)",
      "[rates]\ncontrol = 100.0\n[sensors.y]\nelement = \"y\"\nunit = \"rad\"\n"
      "[sensors.z]\nelement = \"z\"\nunit = \"rad\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N m\"\n"
      "[actuators.w]\nelement = \"w\"\nunit = \"N m\"\n");
}

/// Held upright by what no input says.
FilterPath PathUpright(const Machine& machine, const FilterNoise& noise,
                       Index samples) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  MeasuredRun run;
  run.sample_time = 0.01;
  run.inputs = Eigen::MatrixXd::Zero(2, samples);
  run.outputs.resize(2, samples);
  for (Index k = 0; k < samples; ++k) {
    const double t = 0.01 * static_cast<double>(k);
    run.outputs.col(k) << 0.2 * std::sin(2.0 * t) + 1e-4 * normal(random),
        0.1 * std::sin(3.0 * t) + 1e-4 * normal(random);
  }
  return RunForceFilter(machine, run, {0, 1}, FilterStarts(machine, run, noise.reading),
                        noise);
}

FilterNoise NoiseUpright(double reading, double size) {
  FilterNoise noise;
  noise.reading = VectorXd::Constant(2, reading);
  noise.clock = 1e-8;
  noise.clock_memory = 0.01;
  noise.size = VectorXd::Constant(2, size);
  noise.memory = VectorXd::Constant(2, 0.3);
  noise.white = VectorXd::Constant(2, 0.1 * size);
  return noise;
}

// What rounds off on the way back grows beyond 1e100 along 2500 ticks of a machine that falls,
// unless the recursion takes it out.
TEST(NoiseSlope, IsThatOfAMachineThatFallsToo) {
  const Machine machine = Upright();
  const FilterNoise noise = NoiseUpright(1e-4, 0.3);
  const FilterPath path = PathUpright(machine, noise, 2500);
  const NoiseSlope slope = SlopeAlong(path, noise, 0, 2500);
  const VectorXd x = LogarithmsOf(noise);
  for (Index i = 0; i < 8; ++i) {
    constexpr double kStep = 1e-4;
    const auto deviance = [&](double step) {
      const VectorXd at = x + step * VectorXd::Unit(x.size(), i);
      return Score(path, NoiseOf(at), 0, 2500).deviance.sum();
    };
    const double expected = (deviance(kStep) - deviance(-kStep)) / (2.0 * kStep);
    EXPECT_NEAR(slope.slope[i], expected, 1e-4 * std::abs(expected) + 1e-2) << i;
  }
}

// Behind a noise that is far too small all readings are beyond the corner, and by first order
// nothing holds the machine: a step down the slope gains all the same.
TEST(NoiseSlope, PointsDownWhereAllReadingsAreBeyondTheCorner) {
  const auto bare = [](FilterNoise noise) {
    noise.floor = 0.0;
    return noise;
  };
  const Machine machine = Upright();
  const FilterPath path = PathUpright(machine, bare(NoiseUpright(1e-4, 0.3)), 2500);
  const FilterNoise small = bare(NoiseUpright(1e-6, 1e-3));
  const NoiseSlope slope = SlopeAlong(path, small, 0, 2500);
  const VectorXd step = -0.01 * slope.slope / slope.slope.norm();
  const FilterNoise stepped = bare(NoiseOf(LogarithmsOf(small) + step));
  const double there = Score(path, stepped, 0, 2500).deviance.sum();
  const double promised = 0.01 * slope.slope.norm();
  EXPECT_GT(slope.deviance - there, 0.2 * promised);
  EXPECT_LT(slope.deviance - there, 5.0 * promised);
}

}  // namespace
}  // namespace mjdiag
