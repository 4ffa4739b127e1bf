#include "mjdiag/discovery/hypotheses/work.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

using ::testing::ElementsAre;

TEST(Work, EndsWhenItIsUsedUpAndKeepsWhatIsLeftOut) {
  Work work(10.0);
  work.Add(5.0);
  EXPECT_TRUE(work.MayBegin("a"));
  EXPECT_FALSE(work.MayBegin("b", 5.0));  // more than is left
  work.NoteChange();
  work.Add(5.0);
  EXPECT_FALSE(work.MayBegin("c"));
  EXPECT_FALSE(work.MayBegin("c"));
  EXPECT_THAT(work.left_out(), ElementsAre("b", "c"));
}

TEST(Work, KeepsAPartForWhatComesAfterTheSearch) {
  Work work(10.0);
  work.Add(8.0);
  EXPECT_FALSE(work.MayBegin("further causes"));
  work.EndLaws();
  EXPECT_TRUE(work.MayBegin("a curve"));
  work.Add(1.0);
  EXPECT_FALSE(work.MayBegin("a curve"));
  work.EndSearch();
  EXPECT_TRUE(work.MayBegin("intervals"));
  EXPECT_NEAR(work.Share(2), 0.5, 1e-9);
}

TEST(Work, IsSettledWhenItsAnswerHasNotBecomeBetterForLong) {
  Work work;
  work.Add(20.0);
  work.NoteChange();
  work.Add(24.0);
  EXPECT_TRUE(work.MayBegin("other causes"));
  work.Add(2.0);
  EXPECT_TRUE(work.IsSettled());
  EXPECT_FALSE(work.MayBegin("other causes"));
  EXPECT_TRUE(work.left_out().empty());  // by no budget
  work.EndLaws();
  EXPECT_TRUE(work.MayBegin("a curve"));
}

TEST(Work, EndsAfterAFitThatWasCutShort) {
  Work work;
  EXPECT_TRUE(work.MayBegin("a"));
  work.CutShort();
  EXPECT_FALSE(work.MayBegin("a"));
}

TEST(Work, EndsWhenItIsAskedTo) {
  bool stop = false;
  Work work(Work::kUnlimited, [&] { return stop; });
  EXPECT_TRUE(work.MayBegin("a"));
  stop = true;
  EXPECT_FALSE(work.MayBegin("a"));
}

TEST(Work, IsThatOfTheRunsOfAllCopiesOfAProblem) {
  const test::StageUnderTest stage;
  const auto work = std::make_shared<Work>();
  const DiscoveryProblem problem = stage.Pose(stage.Measure({})).Charging(work);
  const Changes friction = test::With({"coulomb_friction@load:force=18"});
  problem.Residual(friction);
  EXPECT_NEAR(work->used(), problem.RunWork(), 1e-8);
  const DiscoveryProblem part = problem.TrainPart();
  part.Residual(friction);
  EXPECT_NEAR(work->used(), problem.RunWork() + part.RunWork(), 1e-8);
  EXPECT_NEAR(part.RunWork(), 0.7 * problem.RunWork(), 1e-3 * problem.RunWork());
  // The nominal machine is run once.
  problem.Residual({});
  problem.Residual({});
  EXPECT_NEAR(work->used(), 2.0 * problem.RunWork() + part.RunWork(), 1e-8);
}

}  // namespace
}  // namespace mjdiag
