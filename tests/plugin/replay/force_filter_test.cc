#include "mjdiag/plugin/replay/force_filter.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/replay/force_smoother.h"
#include "mjdiag/plugin/replay/linear_pass.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/any_machine.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNoise = 1e-5;

/// A mass on a slide, pushed about, and what its encoder reads, with noise.
struct Slide {
  Machine machine = test::MachineOf(
      R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="j" type="slide" axis="1 0 0" damping="4"/>
      <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></worldbody>
      <actuator><motor name="u" joint="j"/></actuator>
      <sensor><jointpos name="y" joint="j"/></sensor></mujoco>)",
      "[rates]\ncontrol = 1000.0\n[sensors.y]\nelement = \"y\"\nunit = \"m\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N\"\n");

  /// @param force  that nobody knows of, over time [s]
  MeasuredRun Measure(const std::function<double(double)>& force, Index samples = 3000,
                      unsigned seed = 1) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    MeasuredRun run;
    run.sample_time = 1e-3;
    run.outputs.resize(1, samples);
    run.inputs.resize(1, samples);
    double q = 0.1;
    double v = 0.2;
    for (Index k = 0; k < samples; ++k) {
      const double t = 1e-3 * static_cast<double>(k);
      run.outputs(0, k) = q + kNoise * normal(random);
      run.inputs(0, k) = 8.0 * std::sin(9.0 * t) + 3.0 * std::sin(31.0 * t);
      v += 1e-3 * (run.inputs(0, k) + force(t) - 4.0 * v) / (2.0 + 1e-3 * 4.0);
      q += 1e-3 * v;
    }
    return run;
  }
};

double None(double) { return 0.0; }

FilterNoise SomeNoise() {
  return {VectorXd::Constant(1, kNoise),
          1e-12,
          1e-3,
          VectorXd::Constant(1, 0.5),
          VectorXd::Constant(1, 0.2),
          VectorXd::Constant(1, 0.01)};
}

TEST(ForceFilter, LeavesTheNoiseOfItsSensorBesideTheTrueMachine) {
  const Slide slide;
  const MeasuredRun run = slide.Measure(None);
  const VectorXd sd = VectorXd::Constant(1, kNoise);
  const FilterPath path = FilterLikeliest(slide.machine, run, sd);
  // 3000 values: four standard deviations of a root mean square are 5 %.
  const double rms = std::sqrt(path.innovations.squaredNorm() / 3000.0);
  EXPECT_NEAR(rms, kNoise, 0.05 * kNoise);
  EXPECT_NEAR(path.noise.reading[0], kNoise, 0.1 * kNoise);
  EXPECT_LT(path.forces.norm() / std::sqrt(3000.0), 0.05);
}

TEST(ForceFilter, HasANoiseWhereNoTimeIsLeftToLookForABetterOne) {
  const Slide slide;
  const MeasuredRun run = slide.Measure(None);
  const VectorXd sd = VectorXd::Constant(1, kNoise);
  const FilterPath path = FilterLikeliest(slide.machine, run, sd, [] { return true; });
  EXPECT_EQ(path.samples(), run.samples());
  EXPECT_GE(path.deviance, FilterLikeliest(slide.machine, run, sd).deviance);
}

TEST(ForceFilter, BeginsInMidMotion) {
  const Slide slide;
  const MeasuredRun run = slide.Measure(None);
  const auto starts = FilterStarts(slide.machine, run, VectorXd::Constant(1, kNoise));
  EXPECT_NEAR(starts[0].state.position[0], 0.1, 4.0 * kNoise);
  EXPECT_NEAR(starts[0].state.velocity[0], 0.2, 4.0 * starts[0].sd[1]);
  EXPECT_LT(starts[0].sd[1], 0.05);
}

// A blow leaves it behind by more than readings may be off, of which each counts for less: it
// knows less by that, too.
TEST(ForceFilter, ComesBackFromWhatItWasLeftBehindBy) {
  const Slide slide;
  const MeasuredRun run =
      slide.Measure([](double t) { return t > 1.5 && t < 1.51 ? 3.0 : 0.0; }, 3000);
  FilterNoise noise = SomeNoise();
  noise.size[0] = 0.01;
  noise.white[0] = 1e-3;
  const FilterPath path = RunForceFilter(
      slide.machine, run, {0}, FilterStarts(slide.machine, run, noise.reading), noise);
  // 1000 values: four standard deviations of a root mean square are 9 %.
  const double rms = path.innovations.rightCols(1000).norm() / std::sqrt(1000.0);
  EXPECT_NEAR(rms, kNoise, 0.15 * kNoise);
}

// Half of the mass hangs on a spring: a filter that took it for a force from outside would be
// pulled away by it.
TEST(ForceFilter, CorrectsTheBodyThatAnEffectAdds) {
  const Slide slide;
  const double omega = 2.0 * std::numbers::pi * 13.0;
  MeasuredRun run = slide.Measure(None);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  double q = 0.0, v = 0.0, x = 0.0, w = 0.0;
  for (Index k = 0; k < run.samples(); ++k) {
    run.outputs(0, k) = q + kNoise * normal(random);
    const double spring = 2.0 * omega * omega * (x - q);
    v += 1e-3 * (run.inputs(0, k) + spring - 4.0 * v) / (2.0 + 1e-3 * 4.0);
    w -= 1e-3 * spring / 2.0;
    q += 1e-3 * v;
    x += 1e-3 * w;
  }
  const Machine carries = slide.machine.With(
      {{}, {ParseEffect("flexible_mode@j:mass=2,frequency=13,damping_ratio=0")}});
  FilterNoise noise = SomeNoise();
  noise.size[0] = 0.1;
  noise.white[0] = 1e-4;
  const FilterPath path = RunForceFilter(
      carries, run, {0}, FilterStarts(carries, run, noise.reading), noise);
  // 2000 values: four standard deviations of a root mean square are 6 %.
  const double rms = path.innovations.rightCols(2000).norm() / std::sqrt(2000.0);
  EXPECT_NEAR(rms, kNoise, 0.1 * kNoise);
}

// The mass on a table of 3 kg whose mount no sensor sees: a force on the table moves it by the
// inverse of its own mass.
TEST(ForceFilter, KnowsWhatPushesWhereNothingIsDrivenOrMeasured) {
  const Machine machine = test::MachineOf(
      R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="mount" type="slide" axis="1 0 0" stiffness="1e4" damping="30"/>
      <inertial pos="0 0 0" mass="3" diaginertia="1 1 1"/><body>
      <joint name="j" type="slide" axis="1 0 0" damping="4"/>
      <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></body></worldbody>
      <actuator><motor name="u" joint="j"/></actuator>
      <sensor><jointpos name="y" joint="j"/></sensor></mujoco>)",
      "[rates]\ncontrol = 1000.0\n[sensors.y]\nelement = \"y\"\nunit = \"m\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N\"\n");
  const FilterNoise noise = SomeNoise();
  const MeasuredRun run = Slide().Measure(None, 200);
  const FilterPath path = RunForceFilter(
      machine, run, {1}, FilterStarts(machine, run, noise.reading), noise);
  EXPECT_NEAR(path.tangents.front().B(2, 0), 1e-3 / 3.0, 0.02 * 1e-3 / 3.0);
}

// How fast the machine usually is, and not how well its first speed is known, says how large
// the forces may be behind which it is followed whatever it lacks.
TEST(ForceFilter, FollowsAMachineThatBeginsAtRest) {
  const test::Arm arm;
  // It stands still for the first tenth of a second.
  const MeasuredRun run = ToMeasuredRun(
      arm.setup(), test::Arm::Measure({"viscous_friction@shoulder:coefficient=20",
                                       "viscous_friction@elbow:coefficient=10"}));
  const VectorXd sd = VectorXd::Constant(2, test::Arm::kNoise);
  const auto dofs = LatentDofs(arm.machine, run);
  const auto starts = FilterStarts(arm.machine, run, sd);
  EXPECT_LT(starts[0].sd[2], 0.01);
  EXPECT_GT(starts[0].usual[0], 0.3);
  const FilterNoise noise = FollowingNoise(arm.machine, run, dofs, starts, sd);
  const FilterPath path = RunForceFilter(arm.machine, run, dofs, starts, noise);
  // It is raised by more than two radians.
  EXPECT_LT(path.innovations.cwiseAbs().maxCoeff(), 0.05);
}

// Behind all readings more is known of forces than before any, also where a deviation grows
// from tick to tick: a link on its head, read every 10 ms for a minute.
TEST(SmoothForces, KnowTheForcesOfAMachineThatFalls) {
  const Machine machine = test::MachineOf(
      R"(<mujoco><option timestep="0.01"/><worldbody><body>
      <joint name="j" axis="0 1 0"/>
      <inertial pos="0 0 0.4" mass="2" diaginertia="0.05 0.05 0.05"/>
      <body pos="0 0 0.8"><joint name="k" axis="0 1 0"/>
      <inertial pos="0 0 0.3" mass="1" diaginertia="0.02 0.02 0.02"/></body></body></worldbody>
      <actuator><motor name="u" joint="j"/></actuator>
      <sensor><jointpos name="y" joint="j"/><jointpos name="z" joint="k"/></sensor></mujoco>)",
      "[rates]\ncontrol = 100.0\n[sensors.y]\nelement = \"y\"\nunit = \"rad\"\n"
      "[sensors.z]\nelement = \"z\"\nunit = \"rad\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N m\"\n");
  MeasuredRun run;
  run.sample_time = 0.01;
  run.inputs = MatrixXd::Zero(1, 6000);
  run.outputs.resize(2, 6000);
  for (Index k = 0; k < 6000; ++k) {
    run.outputs(0, k) = 0.4 * std::sin(0.03 * static_cast<double>(k));
    run.outputs(1, k) = 0.3 * std::sin(0.05 * static_cast<double>(k));
  }
  const VectorXd sd = VectorXd::Constant(2, kNoise);
  const auto dofs = LatentDofs(machine, run);
  const auto starts = FilterStarts(machine, run, sd);
  const FilterNoise noise = FollowingNoise(machine, run, dofs, starts, sd);
  const SmoothedForces smoothed =
      SmoothForces(RunForceFilter(machine, run, dofs, starts, noise));
  EXPECT_GT(smoothed.sd.minCoeff(), 0.0);
  EXPECT_TRUE((smoothed.sd.array() < noise.size.array()).all()) << smoothed.sd;
}

// Of the same noise the linear pass along a path is the filter itself.
TEST(ForceFilter, IsItsOwnLinearPass) {
  const test::Arm arm;
  const MeasuredRun run = ToMeasuredRun(arm.setup(), test::Arm::Measure());
  const VectorXd sd = VectorXd::Constant(2, test::Arm::kNoise);
  const auto dofs = LatentDofs(arm.machine, run);
  const auto starts = FilterStarts(arm.machine, run, sd);
  const FilterNoise noise = FollowingNoise(arm.machine, run, dofs, starts, sd);
  const FilterPath path = RunForceFilter(arm.machine, run, dofs, starts, noise);
  EXPECT_NEAR(Score(path, noise, 0, run.samples()).deviance.sum(), path.deviance,
              1e-8 * std::abs(path.deviance));
}

// And of another noise, on a machine that is linear, too.
TEST(ForceFilter, OfAnotherNoiseIsTheLinearPassAlongAnyPath) {
  const Slide slide;
  const MeasuredRun run =
      slide.Measure([](double t) { return 0.7 * std::sin(2.0 * t); });
  const auto dofs = LatentDofs(slide.machine, run);
  ASSERT_EQ(dofs, std::vector<Index>{0});
  const auto starts = FilterStarts(slide.machine, run, VectorXd::Constant(1, kNoise));
  const FilterNoise noise = SomeNoise();
  FilterNoise other = noise;
  other.size *= 30.0;
  other.memory *= 5.0;
  other.reading *= 2.0;
  other.clock = 1e-5;
  other.clock_memory = 3e-3;
  const FilterPath path = RunForceFilter(slide.machine, run, dofs, starts, noise);
  const FilterPath exact = RunForceFilter(slide.machine, run, dofs, starts, other);
  EXPECT_NEAR(Score(path, other, 0, run.samples()).deviance.sum(), exact.deviance,
              1e-6 * std::abs(exact.deviance));
}

// What is missing is as little known in what is quick as if that much of it were white, and no
// force of that size is there for it.
TEST(ForceFilter, HasAFloorUnderTheSpectrumOfWhatIsMissing) {
  const Slide slide;
  const MeasuredRun run =
      slide.Measure([](double t) { return 0.7 * std::sin(2.0 * t); });
  const auto starts = FilterStarts(slide.machine, run, VectorXd::Constant(1, kNoise));
  const auto followed = [&](const FilterNoise& noise) {
    return RunForceFilter(slide.machine, run, {0}, starts, noise);
  };
  const FilterNoise floored = SomeNoise();
  ASSERT_GT(floored.floor, 0.0);
  FilterNoise bare = floored;
  bare.floor = 0.0;
  FilterNoise white = bare;
  white.white = floored.WhiteVariance(run.sample_time).cwiseSqrt();
  const FilterPath path = followed(floored);
  EXPECT_DOUBLE_EQ(path.deviance, followed(white).deviance);
  EXPECT_GT(std::abs(path.deviance - followed(bare).deviance), 1.0);
  // The machine is linear: smoothed along any path.
  EXPECT_LT((SmoothForces(path).value - SmoothForces(followed(bare)).value).norm(),
            1e-6 * SmoothForces(path).value.norm());
}

TEST(ForceSmoother, FindsAForceThatIsMissing) {
  const Slide slide;
  const auto force = [](double t) { return t > 1.5 ? -0.6 : 0.9; };
  const MeasuredRun run = slide.Measure(force);
  const FilterPath path =
      FilterLikeliest(slide.machine, run, VectorXd::Constant(1, kNoise));
  const SmoothedForces smoothed = SmoothForces(path);
  // Away from where it jumps.
  for (const double t : {0.3, 0.7, 1.1, 1.9, 2.3, 2.7}) {
    EXPECT_NEAR(smoothed.value(0, static_cast<Index>(1000.0 * t)), force(t), 0.1) << t;
  }
}

// The errors of what lasts are as large as the smoother says: 30 machines with a latent
// force of that noise, mean squares within four standard deviations of 30 x 10 nearly
// independent values.
TEST(ForceSmoother, KnowsHowWellItKnows) {
  const Slide slide;
  FilterNoise noise = SomeNoise();
  noise.white[0] = 1e-9;
  double squares = 0.0;
  double expected = 0.0;
  constexpr int kMachines = 30;
  for (unsigned seed = 1; seed <= kMachines; ++seed) {
    std::mt19937 random(1000 + seed);
    std::normal_distribution<double> normal;
    const double rho = std::exp(-1e-3 / noise.memory[0]);
    std::vector<double> force;
    double w = noise.size[0] * normal(random);
    for (int k = 0; k < 2000; ++k) {
      force.push_back(w);
      w = rho * w + std::sqrt(1.0 - rho * rho) * noise.size[0] * normal(random);
    }
    const MeasuredRun run = slide.Measure(
        [&](double t) {
          return force.at(static_cast<std::size_t>(std::lround(t * 1e3)));
        },
        2000, seed);
    const std::vector<Index> dofs = {0};
    const auto starts = FilterStarts(slide.machine, run, VectorXd::Constant(1, kNoise));
    const SmoothedForces smoothed =
        SmoothForces(RunForceFilter(slide.machine, run, dofs, starts, noise));
    const VectorXd truth = VectorXd::Map(force.data(), std::ssize(force));
    squares += (smoothed.value.row(0).transpose() - truth).squaredNorm() / 2000.0;
    expected += smoothed.sd[0] * smoothed.sd[0];
  }
  EXPECT_NEAR(squares / expected, 1.0, 4.0 * std::sqrt(2.0 / 300.0));
}

// A clock that jitters moves all readings of a tick alike; the noise of single sensors
// would not be it.
TEST(NoiseFit, TellsAClockFromTheNoiseOfSensors) {
  const test::Arm arm;
  // In the steps of the model: others are late or early, too.
  MeasuredRun run = ToMeasuredRun(arm.setup(), test::Arm::Measure({}, 1.0, 2));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const MatrixXd clean = run.outputs;
  constexpr double kJitter = 2e-4;  // [s]
  for (Index k = 1; k + 1 < run.samples(); ++k) {
    run.outputs.col(k) +=
        kJitter * normal(random) * (clean.col(k + 1) - clean.col(k - 1)) / 2e-3;
  }
  const VectorXd sd = VectorXd::Constant(2, test::Arm::kNoise);
  const FilterPath path = FilterLikeliest(arm.machine, run, sd);
  EXPECT_NEAR(path.noise.clock, kJitter, 0.2 * kJitter);
  EXPECT_LT(path.noise.reading.maxCoeff(), 2.0 * test::Arm::kNoise);
}

// -2 ln L orders nothing, half a truth and the truth, and a wrong law does not pass for it.
// A blow of a force in a fifth of a long record, which pieces of it miss: no noise that is a
// quarter larger or smaller is likelier by all of it than what is found, by more than the search
// leaves (2).
TEST(NoiseFit, IsLikeliestByAllOfARecord) {
  const Slide slide;
  constexpr Index kSamples = 40000;
  const MeasuredRun run = slide.Measure(
      [](double t) { return t > 14.0 && t < 22.0 ? std::sin(40.0 * t) : 0.0; },
      kSamples);
  const VectorXd sd = VectorXd::Constant(1, kNoise);
  const FilterPath path = FilterLikeliest(slide.machine, run, sd);
  const auto deviance = [&](const FilterNoise& noise) {
    return RunForceFilter(slide.machine, run, path.dofs, path.starts, noise).deviance;
  };
  for (const double factor : {0.8, 1.25}) {
    for (VectorXd FilterNoise::*part : {&FilterNoise::size, &FilterNoise::memory,
                                        &FilterNoise::white, &FilterNoise::reading}) {
      FilterNoise other = path.noise;
      other.*part *= factor;
      // Bounds: a memory of two ticks to a fifth of the run.
      if (part == &FilterNoise::memory &&
          (other.memory[0] < 2e-3 || other.memory[0] > 8.0))
        continue;
      EXPECT_GT(deviance(other), path.deviance - 2.0) << factor;
    }
  }
}

TEST(NoiseFit, OrdersHalfTruthsAndTruths) {
  const test::Arm arm;
  const MeasuredRun run = ToMeasuredRun(
      arm.setup(), test::Arm::Measure({"coulomb_friction@elbow:force=0.3",
                                       "viscous_friction@shoulder:coefficient=0.8"}));
  const VectorXd sd = VectorXd::Constant(2, test::Arm::kNoise);
  const auto deviance = [&](const std::vector<std::string>& effects) {
    Changes changes;
    for (const std::string& effect : effects) {
      changes.effects.push_back(ParseEffect(effect));
    }
    return FilterLikeliest(arm.machine.With(changes), run, sd).deviance;
  };
  const double nothing = deviance({});
  const double half = deviance({"coulomb_friction@elbow:force=0.3"});
  const double wrong = deviance(
      {"coulomb_friction@elbow:force=0.3", "quadratic_drag@shoulder:coefficient=0.3"});
  const double truth = deviance({"coulomb_friction@elbow:force=0.3",
                                 "viscous_friction@shoulder:coefficient=0.8"});
  EXPECT_LT(half, nothing - 100.0);
  EXPECT_LT(truth, half - 100.0);
  EXPECT_LT(truth, wrong - 100.0);
}

}  // namespace
}  // namespace mjdiag
