#include "mjdiag/discovery/fitting/wave_period.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

TEST(WavePeriod, LeavesAWrongPeriodThatAFitCannotLeave) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = Beginning(
      stage.Pose(
          stage.Measure({"force_ripple@load:amplitude=0.3,period=0.02,phase=0.4"})),
      4000);
  const auto candidates = ListCandidates(stage.machine);
  const std::size_t place = test::Place(candidates, "force_ripple@load");
  ASSERT_TRUE(HasPeriod(candidates[place]));
  ASSERT_EQ(candidates[place].parameters[1].name, "period");
  const CauseFit wrong = FitCauses(problem, candidates,
                                   {{{place, Eigen::Vector3d(0.05, 0.012, 0.0)}}}, {});
  ASSERT_GT(std::abs(wrong.causes[0].value[1] - 0.02), 0.002);
  double least = wrong.train;
  double period = wrong.causes[0].value[1];
  for (const FittedCause& other : OtherPeriods(problem, candidates, wrong, 0)) {
    const CauseFit fit =
        FitCauses(problem, candidates, {{other}}, {.jacobian = false, .secant = true});
    if (fit.train > least) continue;
    least = fit.train;
    period = fit.causes[0].value[1];
  }
  EXPECT_NEAR(period, 0.02, 1e-4);
  // 4000 samples of noise: more than four standard deviations of their mean square.
  EXPECT_NEAR(least, 1.0, 0.1);
}

}  // namespace
}  // namespace mjdiag
