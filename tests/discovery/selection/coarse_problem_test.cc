#include "mjdiag/discovery/selection/coarse_problem.h"

#include <gtest/gtest.h>

#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

// Beside the nominal plant the rest is all of the friction, and half of the steps will
// do; with the friction in the plant noise is left, and they will not.
TEST(CoarseProblem, IsNearUntilNoiseIsLeft) {
  const test::StageUnderTest stage;
  const std::string friction = "coulomb_friction@load:force=20";
  const DiscoveryProblem problem = stage.Pose(stage.Measure({friction}));
  const auto coarse = Coarsen(problem, {});
  ASSERT_TRUE(coarse);
  EXPECT_EQ(coarse->machine().rates().substeps, 1);
  EXPECT_DOUBLE_EQ(coarse->step(), stage.setup().rates.tick());
  const Changes truth = test::With({friction});
  EXPECT_FALSE(IsNear(*coarse, problem, truth));
  EXPECT_FALSE(Coarsen(problem, truth));
}

}  // namespace
}  // namespace mjdiag
