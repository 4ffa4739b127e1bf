#include "mjdiag/plugin/effects/structure/late_dampers.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

/// Position of the stage by a recorded force, with changes and that many steps a tick.
Eigen::VectorXd Moves(const Machine& machine, const Record& driven,
                      const Changes& changes) {
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Machine open = machine.WithSetup(WithoutControllers(machine.setup()));
  return Simulate(open.With(changes), Replay(open.setup(), driven), quiet)
      .At("q")
      .samples;
}

// Half of a step h is what Euler's method is off by to first order: between runs of h and
// h / 2 lies h / 4, of the inputs and of the dampers.
TEST(LateDampers, AreWhatLongerStepsDoBesideTheDelayOfTheirInputs) {
  const test::Stage stage;
  const Machine finer = stage.machine.WithSubsteps(2 * stage.setup().rates.substeps);
  const Record driven = stage.Measure({});
  const double late = 0.25 * stage.setup().rates.step();
  const ActuatorSetup& motor = stage.setup().channels.actuators.front();
  const PlacedEffect delay{Lasting(InputDelay()), motor.element,
                           Eigen::VectorXd::Constant(1, late)};
  const Eigen::VectorXd truth = Moves(finer, driven, {});
  const double inputs_late =
      (Moves(stage.machine, driven, {{}, {delay}}) - truth).norm();
  const double all_late =
      (Moves(stage.machine, driven,
             {{}, {delay, *LateDampers(stage.machine.plant(), late)}}) -
       truth)
          .norm();
  EXPECT_LT(all_late, 0.1 * inputs_late);
}

}  // namespace
}  // namespace mjdiag
