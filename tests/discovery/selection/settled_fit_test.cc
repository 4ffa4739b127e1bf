#include "mjdiag/discovery/selection/settled_fit.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/selection/number_fit.h"

namespace mjdiag {
namespace {

// A motor of half its force, beside numbers that were fitted without it: the mass, the
// friction and the motor itself took over what they could.
TEST(Settled, GoesOnWhereSecantsStall) {
  const test::StageUnderTest stage;
  const Record measured = stage.Measure({}, {{"eta", 0.5}});
  const DiscoveryProblem problem = WithDoubts(stage.Pose(measured), {});
  auto candidates = ListCandidates(stage.machine);
  BoundByRecord(candidates, stage.machine, problem.MotionOf(problem.Nominal()));
  const CauseFit before = FitNumbers(problem, candidates, {}, Work::kUnlimited);
  FittedModel start = before;
  start.causes.push_back(
      {test::Place(candidates, "eta"), Eigen::VectorXd::Constant(1, 0.6)});
  const auto stalled = TryFit(problem, candidates, start,
                              CompareFrom(&before.jacobian, 3, 1e-4, Work::kUnlimited));
  ASSERT_TRUE(stalled);
  EXPECT_GT(stalled->train, 1.2);

  const CauseFit settled = Settled(problem, candidates, *stalled, Work::kUnlimited);
  EXPECT_NEAR(settled.train, 1.0, 0.1);
  EXPECT_NEAR(settled.causes[0].value[0], 0.5, 0.05);

  // What has no work left stays as it is.
  EXPECT_EQ(Settled(problem, candidates, *stalled, 0.0).causes[0].value,
            stalled->causes[0].value);
}

}  // namespace
}  // namespace mjdiag
