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

}  // namespace
}  // namespace mjdiag
