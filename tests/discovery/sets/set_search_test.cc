#include "mjdiag/discovery/sets/set_search.h"

#include <gtest/gtest.h>

#include <set>

#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/sets/set_regression.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

class SetSearch : public ::testing::Test {
 protected:
  explicit SetSearch(const std::vector<std::string>& hidden =
                         {"coulomb_friction@load:force=18",
                          "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"})
      : problem_(
            stage_.Pose(stage_.Measure(hidden)).Doubting({LatenessOf(stage_.machine)})),
        ladder_(problem_),
        candidates_(ListCandidates(stage_.machine)) {
    BoundByRecord(candidates_, stage_.machine, problem_.MotionOf(problem_.Nominal()));
  }
  const FittedModel Nothing() const { return {{}, VectorXd::Zero(1)}; }
  std::set<std::string> NamesIn(const FittedModel& model) const {
    std::set<std::string> names;
    for (const FittedCause& cause : model.causes) {
      names.insert(Describe(candidates_[cause.candidate]));
    }
    return names;
  }
  const std::set<std::string> both_{"coulomb_friction@load", "force_ripple@load"};

  const test::StageUnderTest stage_;
  const DiscoveryProblem problem_;
  const ObserverLadder ladder_;
  std::vector<Candidate> candidates_;
};

// 18 N are millions of times the noise of the encoder: behind a slow observer the stage
// without them is nowhere near the measured one.
TEST_F(SetSearch, FindsCausesFarAboveNoiseTogetherAndNothingElse) {
  const SetSearchResult found = SearchSets(ladder_, candidates_, Nothing(), {});
  EXPECT_TRUE(found.ended);
  EXPECT_EQ(NamesIn(found.best.fit), both_);
  EXPECT_EQ(found.best.rung, ladder_.size() - 1);
  for (const FittedCause& cause : found.best.fit.causes) {
    const bool is_friction = cause.value.size() == 1;
    EXPECT_NEAR(cause.value[0], is_friction ? 18.0 : 1.5, 0.01);
    if (is_friction) continue;
    EXPECT_NEAR(cause.value[1], 0.02, 1e-5);
  }
}

TEST_F(SetSearch, TakesAFewFitsForIt) {
  auto work = std::make_shared<Work>();
  const ObserverLadder ladder(problem_.Charging(work));
  SearchSets(ladder, candidates_, Nothing(), {});
  EXPECT_LT(work->used(), 600.0 * problem_.RunWork());
}

// What a set promises to first order is what it does, for the model is held on the
// measured motion.
TEST_F(SetSearch, ProposesTheLargestCauseWithNearlyItsValue) {
  const auto sets = ProposeSets(ladder_[0], candidates_, Nothing(), {}, 4);
  const auto right = std::ranges::find_if(sets, [&](const ProposedSet& set) {
    return NamesIn(set.model).contains("coulomb_friction@load");
  });
  ASSERT_NE(right, sets.end());
  const auto friction =
      std::ranges::find_if(right->model.causes, [&](const FittedCause& cause) {
        return Describe(candidates_[cause.candidate]) == "coulomb_friction@load";
      });
  EXPECT_NEAR(friction->value[0], 18.0, 0.5);
  EXPECT_GT(right->gain, 1000.0);
}

// The sway of the stage on its springs is off by the second order of the steps, which no
// lateness of its motor makes good.
TEST_F(SetSearch, GoesOnInTheStepsThatTheRecordAsksFor) {
  EXPECT_EQ(SearchSets(ladder_, candidates_, Nothing(), {})
                .ladder[0]
                .machine()
                .rates()
                .substeps,
            stage_.machine.rates().substeps);
  const int substeps = 2 * stage_.machine.rates().substeps;
  const Machine finer = stage_.machine.WithSubsteps(substeps).With(
      test::With({"coulomb_friction@load:force=18",
                  "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"}));
  const DiscoveryProblem problem = stage_.Pose(Simulate(finer, stage_.Motion(), {}))
                                       .Doubting({LatenessOf(stage_.machine)});
  const SetSearchResult found =
      SearchSets(ObserverLadder(problem), candidates_, Nothing(), {});
  EXPECT_EQ(found.ladder[0].machine().rates().substeps, substeps);
  EXPECT_EQ(NamesIn(found.best.fit), both_);
  EXPECT_LT(found.best.fit.numbers[0], 0.1);
}

class SetSearchOfNothing : public SetSearch {
 protected:
  SetSearchOfNothing() : SetSearch({}) {}
};

TEST_F(SetSearchOfNothing, FindsNothing) {
  const SetSearchResult found = SearchSets(ladder_, candidates_, Nothing(), {});
  EXPECT_TRUE(found.ended);
  EXPECT_TRUE(found.best.fit.causes.empty());
}

}  // namespace
}  // namespace mjdiag
