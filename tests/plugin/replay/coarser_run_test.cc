#include "mjdiag/plugin/replay/coarser_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "support/any_machine.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kTick = 1e-3;

Machine Pushed(const std::string& hold) {
  return test::MachineOf(
      R"(<mujoco><option timestep="0.0005"/><worldbody><body>
      <joint name="j" type="hinge" axis="0 1 0" damping="0.4"/>
      <inertial pos="0.1 0 0" mass="2" diaginertia="0.1 0.1 0.1"/></body></worldbody>
      <actuator><motor name="u" joint="j"/></actuator>
      <sensor><jointpos name="y" joint="j"/></sensor></mujoco>)",
      "[rates]\ncontrol = 1000.0\nsubsteps = 2\n[sensors.y]\nelement = \"y\"\n"
      "unit = \"rad\"\n[actuators.u]\nelement = \"u\"\nunit = \"N m\"\nhold = \"" +
          hold + "\"\n");
}

/// Of two records, with inputs that nobody could interpolate.
MeasuredRun Noisy(Index samples) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  MeasuredRun run;
  run.sample_time = kTick;
  run.outputs =
      Eigen::MatrixXd::NullaryExpr(1, samples, [&] { return normal(random); });
  run.inputs = Eigen::MatrixXd::NullaryExpr(1, samples, [&] { return normal(random); });
  run.records = {{}, {}};
  run.records[1].sample = samples / 2;
  return run;
}

class RunInTicks : public testing::TestWithParam<std::string> {};

TEST_P(RunInTicks, MovesItsMachineAsAllOfTheTicksDo) {
  constexpr int kTicks = 5;
  const Machine machine = Pushed(GetParam());
  const MeasuredRun run = Noisy(100);
  const MeasuredRun coarse = Coarser(run, kTicks);
  const Machine slower = InTicksOf(machine, kTicks);
  ASSERT_EQ(coarse.samples(), 20);
  TickMap map(machine), slow(slower);
  RecordedInputs inputs(machine, run), slow_inputs(slower, coarse);
  const VectorXd none = VectorXd::Zero(1);
  PlantState state{VectorXd::Constant(1, 0.3), VectorXd::Constant(1, -0.5),
                   VectorXd(0)};
  PlantState other = state;
  for (Index k = 0; k < coarse.samples(); ++k) {
    EXPECT_EQ(coarse.outputs(0, k), run.outputs(0, k * kTicks));
    EXPECT_NEAR(coarse.inputs(0, k), run.inputs.middleCols(k * kTicks, kTicks).mean(),
                1e-15);
    for (Index i = 0; i < kTicks; ++i) {
      inputs.StayAt(k * kTicks + i);
      state = map.Run(state, none, k * kTicks + i, inputs).state;
    }
    slow_inputs.StayAt(k);
    other = slow.Run(other, none, k, slow_inputs).state;
    ASSERT_NEAR(other.position[0], state.position[0], 1e-12);
    ASSERT_NEAR(other.velocity[0], state.velocity[0], 1e-11);
  }
}

INSTANTIATE_TEST_SUITE_P(Inputs, RunInTicks,
                         testing::Values("zero", "linear", "band_limited"),
                         [](const auto& one) {
                           std::string name = one.param;
                           std::erase(name, '_');
                           return name;
                         });

TEST(CoarserRun, BeginsEveryRecordWhereItBegins) {
  const MeasuredRun coarse = Coarser(Noisy(98), 5);  // 49 of each, 9 and 4 left
  ASSERT_EQ(coarse.records.size(), 2u);
  EXPECT_EQ(coarse.records[1].sample, 9);
  EXPECT_EQ(coarse.samples(), 18);
  EXPECT_EQ(coarse.ticks(), 5);
  const MeasuredRun second = Part(coarse, 1, 9);
  EXPECT_EQ(second.finer_inputs, coarse.finer_inputs.rightCols(45));
  EXPECT_EQ(Joined({Part(coarse, 0, 9), second}).finer_inputs, coarse.finer_inputs);
}

MeasuredRun Swinging(double frequency, double noise) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  MeasuredRun run;
  run.sample_time = kTick;
  run.inputs = Eigen::MatrixXd::Zero(1, 8000);
  run.outputs = Eigen::MatrixXd::NullaryExpr(1, 8000, [&](Index, Index k) {
    return std::sin(2.0 * std::numbers::pi * frequency * kTick *
                    static_cast<double>(k)) +
           noise * normal(random);
  });
  return run;
}

TEST(CoarserRun, LooksAtASwingFourTimesAPeriodAtLeast) {
  const VectorXd sd = VectorXd::Constant(1, 1e-6);
  // A period of 30 ms.
  const int ticks = TicksThatShowMotion(Swinging(33.3, 1e-6), sd, 400);
  EXPECT_GE(ticks, 5);
  EXPECT_LE(ticks, 9);
  // As slow as that leaves the samples that are asked for.
  EXPECT_EQ(TicksThatShowMotion(Swinging(1.0, 1e-6), sd, 400), 20);
}

TEST(CoarserRun, DoesNotTakeTheNoiseOfReadingsForMotion) {
  EXPECT_EQ(TicksThatShowMotion(Swinging(0.01, 0.1), VectorXd::Constant(1, 0.1), 400),
            20);
}

}  // namespace
}  // namespace mjdiag
