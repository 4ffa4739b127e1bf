#include "mjdiag/studies/looked_at_runs.h"

#include <gtest/gtest.h>

#include <atomic>

namespace mjdiag {
namespace {

TEST(LookedAtRuns, AreMadeOnceForAllWaysOfSeeing) {
  std::atomic<int> made = 0;
  const auto make = [&](double deviation, std::uint64_t seed) {
    ++made;
    return Record(deviation + static_cast<double>(seed));
  };
  const auto above = [](double limit) -> LookedAtRuns::Sees {
    return [limit](const Record& record) { return record.sample_time() > limit; };
  };
  LookedAtRuns runs(make, {above(1.0), above(2.0)});
  EXPECT_TRUE(runs.SeenBy(0, 0.5, 1));
  EXPECT_FALSE(runs.SeenBy(1, 0.5, 1));
  EXPECT_TRUE(runs.SeenBy(0, 0.5, 1));
  EXPECT_EQ(made, 1);
  EXPECT_TRUE(runs.SeenBy(1, 0.5, 2));
  EXPECT_TRUE(runs.SeenBy(1, 1.5, 1));
  EXPECT_EQ(made, 3);
}

}  // namespace
}  // namespace mjdiag
