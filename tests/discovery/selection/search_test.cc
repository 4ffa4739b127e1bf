#include "mjdiag/discovery/selection/search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/selection/model_choice.h"

namespace mjdiag {
namespace {

const std::vector<std::string> kDrag = {"quadratic_drag@load:coefficient=20"};

TEST(SearchCauses, AddsWhatExplainsTheRecordAndMeasuresItByWhatItLeaves) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(stage.Measure(kDrag));
  const auto candidates = ListCandidates(stage.machine);
  const SearchResult found = SearchCauses(problem, candidates, {});
  ASSERT_EQ(found.fit().causes.size(), 1u);
  EXPECT_EQ(found.fit().causes[0].candidate,
            test::Place(candidates, "quadratic_drag@load"));
  EXPECT_FALSE(found.significant_rest);
  EXPECT_EQ(found.ladder.size(), 1u);
  ASSERT_EQ(found.rivals.size(), 1u);
  EXPECT_EQ(found.rivals[0].front().cause.candidate, found.fit().causes[0].candidate);
  EXPECT_NEAR(found.evidence.independent()[0],
              IndependentShare(problem, found.fit().residual)[0], 1e-3);
}

// Above a tenth of the sampling rate, too.
TEST(SearchCauses, FindAVibrationUpToAQuarterOfTheSamplingRate) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(
      stage.Measure({"floor_vibration@load:amplitude=5,frequency=240,phase=1"}));
  const auto candidates = ListCandidates(stage.machine);
  const SearchResult found = SearchCauses(problem, candidates, {});
  ASSERT_EQ(found.fit().causes.size(), 1u);
  EXPECT_EQ(found.fit().causes[0].candidate,
            test::Place(candidates, "floor_vibration@load"));
  EXPECT_NEAR(found.fit().causes[0].value[1], 240.0, 0.1);
}

// The other record has no drag: every hypothesis spoils it.
TEST(SearchCauses, AreNotTouchedByHypothesesThatAnotherRecordSpeaksAgainst) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(stage.Measure(kDrag));
  const auto candidates = ListCandidates(stage.machine);
  const MeasuredRun healthy = ToMeasuredRun(stage.setup(), stage.Measure({}));
  SearchOptions options;
  options.unseen = &healthy;
  const SearchResult found = SearchCauses(problem, candidates, options);
  EXPECT_TRUE(found.fit().causes.empty());
  EXPECT_FALSE(found.refuted.empty());
  EXPECT_TRUE(found.significant_rest);
  EXPECT_TRUE(found.ladder.empty());
  EXPECT_EQ(found.evidence.independent(), Eigen::VectorXd::Ones(1));
}

// May add nothing itself, so that all it has is what the search before it found.
TEST(SearchCauses, GoOnFromWhatASearchBeforeThemFound) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(stage.Measure(kDrag));
  const auto candidates = ListCandidates(stage.machine);
  const FittedCause drag{test::Place(candidates, "quadratic_drag@load"),
                         Eigen::VectorXd::Constant(1, 15.0)};
  const FittedCause refuted{test::Place(candidates, "force_offset@load"),
                            Eigen::VectorXd::Constant(1, 0.1)};
  CauseFit rough;
  rough.causes = {drag};
  SearchResult before;
  before.evidence = {{}, rough, Eigen::VectorXd::Ones(1)};
  before.rivals = {{{drag, 0.0, 1.0}}};
  before.ladder = {FittedModel({drag})};
  before.refuted = {refuted};
  before.exchanged = true;
  SearchOptions options;
  options.most_causes = 0;
  options.last_fit = false;
  const SearchResult found = SearchCauses(problem, candidates, options, &before);
  ASSERT_EQ(found.fit().causes.size(), 1u);
  EXPECT_EQ(found.fit().causes[0].candidate, drag.candidate);
  EXPECT_NEAR(found.fit().causes[0].value[0], 20.0, 0.5);  // fitted anew
  EXPECT_FALSE(found.significant_rest);
  ASSERT_EQ(found.rivals.size(), 1u);
  EXPECT_EQ(found.rivals[0].front().cause.candidate, drag.candidate);
  EXPECT_EQ(found.ladder.size(), 1u);
  ASSERT_EQ(found.refuted.size(), 1u);
  EXPECT_EQ(found.refuted[0].candidate, refuted.candidate);
}

// The spring alone makes the damper and the motor take over what the gears take, where
// they are fitted and nowhere else: what is held out turns it down.
TEST(SearchCauses, GoOnFromHalfOfTheTruth) {
  const test::StageUnderTest stage;
  const Record measured = stage.Measure(
      {"cubic_stiffness@load:coefficient=100",
       "gear_load_friction@load:motor_share=0.01,load_share=0.005,quadratic=1e-5"});
  const DiscoveryProblem problem = WithDoubts(stage.Pose(measured), {});
  auto candidates = ListCandidates(stage.machine);
  BoundByRecord(candidates, stage.machine, problem.MotionOf(problem.Nominal()));
  SearchOptions options;
  options.exchange = false;
  const SearchResult found = SearchCauses(problem, candidates, options);
  std::vector<std::string> names;
  for (const FittedCause& cause : found.fit().causes) {
    names.push_back(Describe(candidates[cause.candidate]));
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("cubic_stiffness@load",
                                                   "gear_load_friction@load"));
}

}  // namespace
}  // namespace mjdiag
