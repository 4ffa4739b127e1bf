#include "mjdiag/discovery/fitting/unsteady_fit.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

/// A cause of one parameter as a fit at that value.
CauseFit FitAt(const DiscoveryProblem& problem,
               const std::vector<Candidate>& candidates, const std::string& site,
               double value) {
  return FitCauses(
      problem, candidates,
      {{{test::Place(candidates, site), Eigen::VectorXd::Constant(1, value)}}},
      {.iterations = 0, .jacobian = false});
}

TEST(UnsteadyFit, ASmoothMachineIsSteadyAndItsSolutionTheBestPlace) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem =
      stage.Pose(stage.Measure({"quadratic_drag@load:coefficient=20"}));
  const auto candidates = ListCandidates(stage.machine);
  const CauseFit truth = FitAt(problem, candidates, "quadratic_drag@load", 20.0);
  EXPECT_LT(Unsteadiness(problem, candidates, truth), 1.0);
  EXPECT_FALSE(LookAround(problem, candidates, truth, 10.0));
  const CauseFit off = FitAt(problem, candidates, "quadratic_drag@load", 20.6);
  const auto better = LookAround(problem, candidates, off, 10.0);
  ASSERT_TRUE(better);
  EXPECT_NEAR(better->causes[0].value[0], 20.0, 0.1);
}

// A gap of nanoradians in a stiff guide: no change is too small to change the course.
TEST(UnsteadyFit, SeesThatACourseDependsOnTheLastDigit) {
  const Machine machine = test::Bonder();
  const Trajectories& motions = machine.setup().trajectories;
  const Record measured =
      Simulate(machine.With(test::With({"backlash@u4:gap=1.5e-9"})),
               FollowTrajectory(machine.setup(), motions.Find(motions.fallback)), {});
  const DiscoveryProblem problem = PoseProblem(machine, measured, 0.7, 0.0);
  const auto candidates = ListCandidates(machine);
  const CauseFit truth = FitAt(problem, candidates, "backlash@u4", 1.5e-9);
  EXPECT_GT(Unsteadiness(problem, candidates, truth), 30.0);
}

}  // namespace
}  // namespace mjdiag
