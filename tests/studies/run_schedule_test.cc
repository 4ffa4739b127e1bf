#include "mjdiag/studies/cluster/run_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace mjdiag {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::int64_t> Numbers(const std::vector<RunRange>& ranges) {
  std::vector<std::int64_t> runs;
  for (const RunRange& range : ranges) {
    for (std::int64_t run = range.begin; run < range.end; ++run) runs.push_back(run);
  }
  return runs;
}

std::vector<std::int64_t> FirstRuns(std::int64_t count) {
  std::vector<std::int64_t> runs(static_cast<std::size_t>(count));
  std::iota(runs.begin(), runs.end(), 0);
  return runs;
}

/// Ranks that make runs as fast as they say, till all are made.
std::vector<int> MakersOf(RunSchedule& schedule, const std::vector<int>& threads,
                          std::int64_t runs) {
  std::vector<int> makers(static_cast<std::size_t>(runs), 0);
  const auto ranks = static_cast<int>(threads.size());
  for (double now = 0.0; !schedule.is_finished(); now += 0.1) {
    for (int rank = 0; rank < ranks; ++rank) {
      schedule.Heard(rank, threads[static_cast<std::size_t>(rank)], now);
      const auto made = Numbers(schedule.Grant(rank, now));
      for (const std::int64_t run : made) ++makers[static_cast<std::size_t>(run)];
      schedule.Done(rank, made);
    }
  }
  return makers;
}

TEST(RunSchedule, HandsEveryRunOutOnce) {
  RunSchedule schedule(FirstRuns(1000), 1000, 3, 5.0, 0.0);
  EXPECT_THAT(MakersOf(schedule, {1, 2, 8}, 1000), ::testing::Each(1));
}

TEST(RunSchedule, LeavesOutWhatIsThere) {
  RunSchedule schedule({3, 4, 9}, 10, 1, 5.0, 0.0);
  schedule.Heard(0, 8, 0.0);
  EXPECT_THAT(Numbers(schedule.Grant(0, 0.0)), ElementsAre(3, 4, 9));
}

TEST(RunSchedule, GivesNothingToOneThatIsNotReady) {
  RunSchedule schedule(FirstRuns(5), 5, 2, 5.0, 0.0);
  EXPECT_THAT(schedule.Grant(1, 0.0), IsEmpty());
}

TEST(RunSchedule, HoldsNothingBackAtTheEnd) {
  RunSchedule schedule(FirstRuns(6), 6, 2, 5.0, 0.0);
  schedule.Heard(0, 2, 0.0);
  schedule.Heard(1, 2, 0.0);
  EXPECT_EQ(Numbers(schedule.Grant(0, 0.0)).size(), 2u);
  EXPECT_EQ(Numbers(schedule.Grant(1, 0.0)).size(), 2u);
  EXPECT_THAT(schedule.Grant(0, 0.0), IsEmpty());
  schedule.Done(1, {2});
  EXPECT_THAT(Numbers(schedule.Grant(1, 0.0)), ElementsAre(4));
}

TEST(RunSchedule, RepeatsTheRunsOfASilentRank) {
  RunSchedule schedule(FirstRuns(4), 4, 2, 5.0, 0.0);
  schedule.Heard(0, 1, 0.0);
  schedule.Heard(1, 1, 0.0);
  EXPECT_THAT(Numbers(schedule.Grant(1, 0.0)), ElementsAre(0));
  schedule.Heard(0, 1, 6.0);
  EXPECT_THAT(schedule.TakeSilent(6.0), ElementsAre(1));
  EXPECT_THAT(schedule.TakeSilent(6.0), IsEmpty());
  EXPECT_THAT(schedule.Grant(1, 6.0), IsEmpty());
  for (const std::int64_t run : {0, 1, 2, 3}) {
    EXPECT_THAT(Numbers(schedule.Grant(0, 6.0)), ElementsAre(run));
    schedule.Done(0, {run});
  }
  EXPECT_TRUE(schedule.is_finished());
}

TEST(RunSchedule, TakesASilentRankBackAndCountsNothingTwice) {
  RunSchedule schedule(FirstRuns(3), 3, 2, 5.0, 0.0);
  schedule.Heard(1, 1, 0.0);
  EXPECT_THAT(Numbers(schedule.Grant(1, 0.0)), ElementsAre(0));
  schedule.Heard(0, 1, 6.0);
  EXPECT_THAT(schedule.TakeSilent(6.0), ElementsAre(1));
  EXPECT_THAT(Numbers(schedule.Grant(0, 6.0)), ElementsAre(0));
  schedule.Heard(1, 1, 7.0);  // it was only asleep, and had made it
  schedule.Done(1, {0});
  schedule.Done(0, {0});
  EXPECT_EQ(schedule.done(), 1);
  EXPECT_THAT(Numbers(schedule.Grant(1, 7.0)), ElementsAre(1));
  EXPECT_THAT(Numbers(schedule.Grant(0, 7.0)), ElementsAre(2));
}

TEST(RunSchedule, GivesNoRunsToARankThatFailed) {
  RunSchedule schedule(FirstRuns(2), 2, 2, 5.0, 0.0);
  schedule.Heard(0, 1, 0.0);
  schedule.Heard(1, 1, 0.0);
  EXPECT_THAT(Numbers(schedule.Grant(1, 0.0)), ElementsAre(0));
  schedule.Retire(1);
  schedule.Heard(1, 1, 1.0);
  EXPECT_THAT(schedule.Grant(1, 1.0), IsEmpty());
  EXPECT_THAT(Numbers(schedule.Grant(0, 1.0)), ElementsAre(0));
  EXPECT_TRUE(schedule.has_workers());
  schedule.Retire(0);
  EXPECT_FALSE(schedule.has_workers());
}

TEST(RunSchedule, GivesASlowRankNoMoreThanItMakesInAMoment) {
  RunSchedule schedule(FirstRuns(100000), 100000, 2, 5.0, 0.0);
  schedule.Heard(0, 1, 0.0);
  schedule.Heard(1, 1, 0.0);
  std::vector<std::int64_t> has = Numbers(schedule.Grant(1, 0.0));
  for (double now = 1.0; now < 20.0; now += 1.0) {  // a run a second
    schedule.Done(1, {has.front()});
    has.erase(has.begin());
    for (const std::int64_t run : Numbers(schedule.Grant(1, now))) has.push_back(run);
    EXPECT_LE(has.size(), 4u) << now;
  }
}

}  // namespace
}  // namespace mjdiag
