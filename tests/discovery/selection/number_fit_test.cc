#include "mjdiag/discovery/selection/number_fit.h"

#include <gtest/gtest.h>

#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/hypotheses/candidate.h"

namespace mjdiag {
namespace {

/// Of the stage in steps half as long: what a machine is beside its simulation.
Record MeasuredInFinerSteps(const test::Stage& stage) {
  RunOptions options;
  return Simulate(stage.machine.WithSubsteps(2 * stage.machine.rates().substeps),
                  stage.Motion(), options);
}

TEST(FitNumbers, LeavesNoiseOfAMachineThatIsNoSimulationInSteps) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem =
      WithDoubts(stage.Pose(MeasuredInFinerSteps(stage)), {});
  ASSERT_TRUE(problem.numbers().back().is_lateness);
  const auto candidates = ListCandidates(stage.machine);
  const CauseFit fit = FitNumbers(problem, candidates, {}, Work::kUnlimited);
  EXPECT_NEAR(fit.train, 1.0, 0.1);
  // Half of a step of the one less half of a step of the other.
  const double late = problem.numbers().back().spread * fit.numbers.tail(1)[0];
  EXPECT_NEAR(late / problem.step(), 0.25, 0.05);

  std::vector<DoubtedNumber> others = problem.numbers();
  others.pop_back();
  EXPECT_GT(
      FitNumbers(problem.Doubting(others), candidates, {}, Work::kUnlimited).train,
      1.5);
}

TEST(FitNumbers, GoOnFromThoseThatWereFoundBefore) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem =
      WithDoubts(stage.Pose(MeasuredInFinerSteps(stage)), {});
  const auto candidates = ListCandidates(stage.machine);
  const CauseFit found = FitNumbers(problem, candidates, {}, Work::kUnlimited);
  const Eigen::VectorXd near = found.numbers.array() + 1e-7;
  const CauseFit again = FitNumbers(problem, candidates, near, Work::kUnlimited);
  EXPECT_EQ(again.numbers, near);  // noise is all that is left
}

}  // namespace
}  // namespace mjdiag
