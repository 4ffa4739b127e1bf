#include "mjdiag/discovery/fitting/screening_in_place.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// A drag and an offset of the motor, both found.
struct Found {
  test::StageUnderTest stage;
  DiscoveryProblem problem = stage.Pose(stage.Measure(
      {"quadratic_drag@load:coefficient=20", "force_offset@load:force=0.05"}));
  std::vector<Candidate> candidates = ListCandidates(stage.machine);
  CauseFit fit = FitCauses(
      problem, candidates,
      {{{test::Place(candidates, "quadratic_drag@load"), VectorXd::Constant(1, 20.0)},
        {test::Place(candidates, "force_offset@load"), VectorXd::Constant(1, 0.05)}}},
      {});
};

TEST(ScreeningInPlace, FindsAgainTheCauseThatIsThere) {
  const Found found;
  const Screening screening =
      ScreenInPlace(found.problem, found.candidates, found.fit, {0}, 1);
  const Start& best = screening.starts.front();
  EXPECT_EQ(best.cause.candidate, found.fit.causes[0].candidate);
  EXPECT_NEAR(best.cause.value[0], found.fit.causes[0].value[0], 0.2);
  const double explained = ExplainedBy(found.problem, found.fit, screening);
  EXPECT_NEAR(best.gain, explained, 0.02 * explained);
}

// What the other cause would take over, a fit of it alone shows.
TEST(ScreeningInPlace, SaysWhatIsLostWithoutACause) {
  const Found found;
  for (const std::size_t i : {0u, 1u}) {
    const double loss = LossWithout(found.problem, found.candidates, found.fit, i);
    const CauseFit other =
        FitCauses(found.problem, found.candidates, ModelWithout(found.fit, {i}), {});
    const double lost = FittedValues(found.problem) * (other.train - found.fit.train);
    EXPECT_GT(lost, 500.0) << "hardly shows";
    EXPECT_NEAR(loss, lost, 0.1 * lost) << i;
  }
}

TEST(ScreeningInPlace, SaysWhatIsLostWithoutTheOnlyCause) {
  const Found found;
  const CauseFit fit =
      FitCauses(found.problem, found.candidates, ModelWithout(found.fit, {1}), {});
  const double lost =
      FittedValues(found.problem) *
      (FitCauses(found.problem, found.candidates, {}, {}).train - fit.train);
  EXPECT_NEAR(LossWithout(found.problem, found.candidates, fit, 0), lost, 0.1 * lost);
}

}  // namespace
}  // namespace mjdiag
