#include "mjdiag/watch/stream/tick_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace mjdiag {
namespace {

constexpr std::array<double, 2> kValues = {1.0, 2.0};

void Fill(TickQueue& queue, std::int64_t from, std::int64_t until) {
  for (std::int64_t k = from; k < until; ++k) queue.Add({0, k, 0.0, 0.0}, kValues);
}

TEST(TickQueueTest, GivesWhatItGotInOrder) {
  StreamCounts counts;
  TickQueue queue(2, 10, TickQueue::WhenFull::kLose, counts);
  Fill(queue, 0, 3);
  TickBlock block;
  queue.Take(0.0, block);
  ASSERT_EQ(block.size(), 3U);
  EXPECT_EQ(block.heads[2].number, 2);
  EXPECT_EQ(block.ValuesOf(2, 2)[1], 2.0);
  queue.Take(0.0, block);
  EXPECT_EQ(block.size(), 0U);
}

TEST(TickQueueTest, LosesInOnePieceAndCountsIt) {
  StreamCounts counts;
  TickQueue queue(2, 10, TickQueue::WhenFull::kLose, counts);
  Fill(queue, 0, 25);
  TickBlock block;
  queue.Take(0.0, block);
  EXPECT_EQ(block.size(), 10U);
  EXPECT_EQ(block.heads.back().number, 9);
  EXPECT_EQ(counts.no_room, 15);
  EXPECT_EQ(queue.deepest(), 10U);
  Fill(queue, 25, 30);
  queue.Take(0.0, block);
  EXPECT_EQ(block.heads.front().number, 25);
}

TEST(TickQueueTest, LosesNothingOfAFileThatCanWait) {
  StreamCounts counts;
  TickQueue queue(2, 10, TickQueue::WhenFull::kWait, counts);
  std::thread writer([&] {
    Fill(queue, 0, 1000);
    queue.Close();
  });
  std::int64_t next = 0;
  TickBlock block;
  do {
    queue.Take(1.0, block);
    for (const TickHead& head : block.heads) EXPECT_EQ(head.number, next++);
  } while (block.size() > 0);
  writer.join();
  EXPECT_EQ(next, 1000);
  EXPECT_EQ(counts.no_room, 0);
}

}  // namespace
}  // namespace mjdiag
