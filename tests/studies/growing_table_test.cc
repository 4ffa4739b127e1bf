#include "mjdiag/studies/growing_table.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>

namespace mjdiag {
namespace {

TEST(GrowingTable, ShowsRowsInTheirOrderAsSoonAsItCan) {
  std::vector<std::size_t> seen;
  GrowingTable table({"t", {"run"}, {}, {}}, [&](const StudyTable& shown) {
    seen.push_back(shown.rows.size());
  });
  table.Put(1, {"second"});
  EXPECT_TRUE(seen.empty());
  table.Put(0, {"first"});
  table.Put(2, {"third"});
  EXPECT_EQ(seen, (std::vector<std::size_t>{1, 2, 3}));
  ASSERT_EQ(table.table().rows.size(), 3u);
  EXPECT_EQ(table.table().rows[0][0].text, "first");
  EXPECT_EQ(table.table().rows[1][0].text, "second");
}

TEST(ParallelInOrder, DoesEveryTaskOnceAndBeginsWithTheFirst) {
  std::array<std::atomic<int>, 50> done{};
  std::atomic<int> first = -1;
  ParallelInOrder(50, [&](int i) {
    int none = -1;
    first.compare_exchange_strong(none, i);
    ++done[static_cast<std::size_t>(i)];
  });
  for (const auto& times : done) EXPECT_EQ(times, 1);
  EXPECT_LT(first, 50 / 4);  // others may have begun beside it
}

}  // namespace
}  // namespace mjdiag
