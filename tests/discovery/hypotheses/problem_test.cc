#include "mjdiag/discovery/hypotheses/problem.h"

#include <gtest/gtest.h>

#include <vector>

#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

/// A problem with something to explain.
DiscoveryProblem Posed(const test::StageUnderTest& stage) {
  return stage.Pose(stage.Measure({"quadratic_drag@load:coefficient=20"}));
}

Track Replayed(const DiscoveryProblem& problem) {
  return FollowRun(problem.machine(), {}, problem.run(), problem.observer(), true);
}

TEST(DiscoveryProblem, FindsTheNominalRunOnceForAllItsCopies) {
  const test::StageUnderTest stage;
  const std::vector<DiscoveryProblem> copies(2, Posed(stage));
  const DiscoveryProblem& problem = copies[0];
  EXPECT_EQ(&copies[1].Nominal(), &problem.Nominal());
  EXPECT_EQ(copies[1].Linearised({}), problem.Linearised({}));
  EXPECT_EQ(copies[1].TrainPart().Linearised({}), problem.TrainPart().Linearised({}));
  const Track replayed = Replayed(problem);
  EXPECT_EQ(problem.Nominal().innovations, replayed.innovations);
  EXPECT_EQ(problem.Nominal().position, replayed.position);
  EXPECT_EQ(problem.Residual({}), problem.Scaled(replayed));
}

TEST(DiscoveryProblem, FindsItAnewWhereTheRunIsAnother) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = Posed(stage);
  problem.Nominal();  // what variants must not take over
  const DiscoveryProblem coarse = problem.WithSubsteps(1);
  EXPECT_EQ(coarse.Nominal().innovations, Replayed(coarse).innovations);
  EXPECT_NE(coarse.Nominal().innovations, problem.Nominal().innovations);
  const DiscoveryProblem healthy =
      problem.WithRun(ToMeasuredRun(stage.setup(), stage.Measure({})));
  EXPECT_EQ(healthy.Nominal().innovations, Replayed(healthy).innovations);
  EXPECT_NE(healthy.Nominal().innovations, problem.Nominal().innovations);
  const Changes drag = test::With({"quadratic_drag@load:coefficient=20"});
  EXPECT_NE(problem.Residual(drag), problem.Residual({}));
  EXPECT_EQ(problem.Scaled(problem.Follow(drag)), problem.Residual(drag));
}

TEST(DiscoveryProblem, HasATrainPartThatIsItsBeginningAndAllForTheFit) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = Posed(stage);
  const DiscoveryProblem part = problem.TrainPart();
  ASSERT_LT(problem.train(), problem.run().samples());
  EXPECT_EQ(part.run().samples(), problem.train());
  EXPECT_EQ(part.train(), problem.train());
  EXPECT_EQ(part.Nominal().innovations,
            problem.Nominal().innovations.leftCols(problem.train()));
}

}  // namespace
}  // namespace mjdiag
