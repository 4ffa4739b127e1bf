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

TEST(CoarseProblem, IsExactWhereItIsShiftedToBeSo) {
  const test::StageUnderTest stage;
  const std::string friction = "coulomb_friction@load:force=20";
  const DiscoveryProblem problem =
      WithDoubts(stage.Pose(stage.Measure({friction})), {});
  const Changes truth = test::With({friction});
  const Eigen::VectorXd exact = problem.Residual(truth);
  const DiscoveryProblem longer = problem.WithSubsteps(1);
  const DiscoveryProblem shifted = longer.Shifted(exact - longer.Residual(truth));
  EXPECT_FALSE(IsNear(longer, problem, truth));
  EXPECT_TRUE(IsNear(shifted, problem, truth));
  // So is its beginning, and another run of the machine has the steps of the setup.
  constexpr Eigen::Index kSamples = 1000;
  const Eigen::VectorXd beginning = Beginning(shifted, kSamples).Residual(truth);
  EXPECT_LT((beginning - exact.head(kSamples)).norm(), 1e-9 * beginning.norm());
  EXPECT_EQ(shifted.WithRun(problem.run()).Residual(truth), exact);
  // A shift that is far above noise may be anything a little away.
  EXPECT_FALSE(Coarsen(problem, truth));
}

}  // namespace
}  // namespace mjdiag
