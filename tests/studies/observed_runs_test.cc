#include "mjdiag/studies/observed_runs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

// To first order: what differences of whole runs show.
TEST(ObservedRuns, ForcesOfNumbersShowWhatTheirChangesDo) {
  const test::Stage stage;
  const ObservedRuns runs(stage.machine, stage.Motion());
  const mjModel& plant = stage.machine.plant();
  const MeasuredRun run = runs.RunOf(stage.machine);
  const Eigen::VectorXd still = StillSpeeds(plant, Eigen::VectorXd::Constant(1, 1e-8),
                                            stage.machine.rates().tick());
  const auto numbers = ModelParameters(plant);
  ASSERT_EQ(numbers.size(), 4u);  // mass, inertia of what slides, damper, motor
  for (const ModelParameter& number : numbers) {
    constexpr double kStep = 1e-5;
    const auto moved = [&](double by) {
      return runs.Innovations(run, {{}, {}, {{number, std::exp(by)}}});
    };
    const Eigen::VectorXd exact = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
    const Eigen::VectorXd rough = -runs.ResponseTo(NumberForce(
        plant, stage.machine.actuator_addresses(), number, runs.motion(), still));
    EXPECT_LE((rough - exact).norm(), 0.02 * exact.norm() + 1e-9)
        << ModelParameterName(plant, number);
  }
}

TEST(ObservedRuns, OfTheMachineItselfShowNothing) {
  const test::Stage stage;
  const ObservedRuns runs(stage.machine, stage.Motion());
  EXPECT_LT(runs.Innovations(runs.RunOf(stage.machine)).norm(), 1e-3);
}

}  // namespace
}  // namespace mjdiag
