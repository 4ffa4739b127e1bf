#include "mjdiag/discovery/selection/coarse_problem.h"

#include <gtest/gtest.h>

#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

// Beside the nominal plant the rest is all of the friction, and half of the steps will
// do; with the friction in the plant noise is left, and they will not.
TEST(CoarseProblem, IsNearUntilNoiseIsLeft) {
  const test::Stage stage;
  const std::string friction = "coulomb_friction@load:force=20";
  const DiscoveryProblem problem = stage.Pose(stage.Measure({friction}));
  const auto coarse = Coarsen(problem, {});
  ASSERT_NE(coarse, nullptr);
  EXPECT_EQ(coarse->setup.rates.substeps, 1);
  EXPECT_DOUBLE_EQ(coarse->plant->opt.timestep, stage.setup.rates.tick());
  Changes truth;
  truth.effects = {ParseEffect(friction)};
  EXPECT_FALSE(IsNear(*coarse, problem, truth));
  EXPECT_EQ(Coarsen(problem, truth), nullptr);
}

}  // namespace
}  // namespace mjdiag
