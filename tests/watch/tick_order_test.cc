#include "mjdiag/watch/stream/tick_order.h"

#include <gtest/gtest.h>

#include <vector>

#include "watch/taken_ticks.h"

namespace mjdiag {
namespace {

class TickOrderTest : public testing::Test {
 protected:
  void Add(std::vector<std::int64_t> numbers, std::uint32_t stream = 1) {
    const std::vector<double> values = {1, 2, 3};
    for (const std::int64_t number : numbers) {
      order_.Add({stream, number, 0.0, now_}, values);
    }
  }

  OrderOptions options_{.window = 4, .patience = 0.1, .silence = 1.0, .old_ticks = 3};
  test::OrderedText seen_;
  TickOrder order_{options_, seen_};
  double now_ = 100.0;
};

TEST_F(TickOrderTest, PassesOnWhatIsInOrder) {
  Add({5, 6, 7});
  EXPECT_EQ(seen_.text, "| 5 6 7 ");
}

TEST_F(TickOrderTest, PutsBackWhatCameOutOfOrder) {
  Add({1, 2, 5, 4, 3, 6});
  EXPECT_EQ(seen_.text, "| 1 2 3 4 5 6 ");
  EXPECT_EQ(order_.counts().reordered, 2);
  EXPECT_EQ(order_.counts().missing, 0);
}

TEST_F(TickOrderTest, DropsWhatCameTwice) {
  Add({1, 2, 2, 1, 4, 4, 3, 4});
  EXPECT_EQ(seen_.text, "| 1 2 3 4 ");
  EXPECT_EQ(order_.counts().repeated, 4);
}

TEST_F(TickOrderTest, GivesUpWhatIsMissingWhenTooManyWait) {
  Add({1, 4, 5, 6, 7});
  EXPECT_EQ(seen_.text, "| 1 ");
  Add({8});
  EXPECT_EQ(seen_.text, "| 1 -2 4 5 6 7 8 ");
  EXPECT_EQ(order_.counts().missing, 2);
  EXPECT_EQ(order_.counts().gaps, 1);
  Add({3});
  EXPECT_EQ(order_.counts().late, 1);
  EXPECT_EQ(seen_.text, "| 1 -2 4 5 6 7 8 ");
}

TEST_F(TickOrderTest, GivesUpWhatIsMissingWhenTimePasses) {
  Add({1, 3});
  order_.Pass(now_ + 0.05);
  EXPECT_EQ(seen_.text, "| 1 ");
  order_.Pass(now_ + 0.2);
  EXPECT_EQ(seen_.text, "| 1 -1 3 ");
}

TEST_F(TickOrderTest, ASecondSenderDoesNotDriveTheFirstOneOut) {
  Add({1, 2});
  Add({70, 71}, 2);
  Add({3});
  EXPECT_EQ(seen_.text, "| 1 2 3 ");
  EXPECT_EQ(order_.counts().foreign, 2);
}

TEST_F(TickOrderTest, ASenderThatStartsAnewIsTakenWhenTheOldOneIsSilent) {
  Add({1, 2, 4});
  now_ += 1.1;
  Add({70, 71}, 2);
  EXPECT_EQ(seen_.text, "| 1 2 -1 4 | 70 71 ");
  EXPECT_EQ(order_.counts().runs, 2);
}

TEST_F(TickOrderTest, ACountThatBeginsAnewIsANewRun) {
  Add({100, 101, 1, 2, 3, 4, 5});
  EXPECT_EQ(seen_.text, "| 100 101 | 4 5 ");
}

TEST_F(TickOrderTest, ANumberFromNowhereCostsAFewTicksOnly) {
  Add({1, 2, 1'000'000'000'000, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_EQ(seen_.text, "| 1 2 3 4 5 6 7 8 9 ");
  order_.Pass(now_ + 1.0);
  Add({10, 11, 12, 13, 14});
  EXPECT_EQ(seen_.text, "| 1 2 3 4 5 6 7 8 9 -999999999990 1000000000000 | 13 14 ");
}

}  // namespace
}  // namespace mjdiag
