#include "mjdiag/plugin/runtime/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

TEST(ParallelFor, DoesEveryTaskOnce) {
  for (const int count : {0, 1, 2, 1000}) {
    std::vector<std::atomic<int>> done(static_cast<std::size_t>(count));
    ParallelFor(count, [&](int i) { ++done.at(static_cast<std::size_t>(i)); });
    for (const auto& times : done) EXPECT_EQ(times, 1) << count;
  }
}

TEST(ParallelFor, UsesMoreThanOneThread) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  // Each task waits for the other, which one thread alone could not end.
  std::atomic<int> begun{0};
  ParallelFor(2, [&](int) {
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  EXPECT_EQ(begun, 2);
}

TEST(ParallelFor, BeginsNothingMoreAfterAnException) {
  // 10000 tasks of a millisecond would follow it.
  std::atomic<int> begun{0};
  const std::string message = test::MessageOf<InputError>([&] {
    ParallelFor(10000, [&](int i) {
      ++begun;
      if (i == 3) throw InputError("task", "three", "another");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    });
  });
  EXPECT_EQ(message, InputError("task", "three", "another").what());
  EXPECT_LT(begun, 10000);
}

TEST(ParallelFor, ThrowsTheFirstOfTwoExceptions) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  std::atomic<int> begun{0};
  EXPECT_THROW(ParallelFor(2,
                           [&](int i) {
                             ++begun;
                             while (begun < 2) std::this_thread::yield();
                             if (i == 0) throw InputError("task", "zero", "another");
                             // Long after the other one was kept.
                             std::this_thread::sleep_for(std::chrono::milliseconds(50));
                             throw std::runtime_error("one");
                           }),
               InputError);
}

TEST(ParallelFor, EndsAllThreadsBeforeItThrows) {
  std::atomic<int> running{0};
  EXPECT_THROW(
      ParallelFor(100,
                  [&](int i) {
                    ++running;
                    if (i > 0) {
                      std::this_thread::sleep_for(std::chrono::milliseconds(5));
                    }
                    --running;
                    if (i == 0) throw std::runtime_error("");
                  }),
      std::runtime_error);
  EXPECT_EQ(running, 0);
}

TEST(ParallelFor, TellsItsProgressToTheCallersThread) {
  const auto caller = std::this_thread::get_id();
  std::vector<double> fractions;
  ParallelFor(
      50, [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); },
      [&](double fraction) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        fractions.push_back(fraction);
      });
  // The other threads may have done all of it.
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    EXPECT_GT(fractions[i], i == 0 ? 0.0 : fractions[i - 1] - 1e-15);
    EXPECT_LE(fractions[i], 1.0);
  }
}

}  // namespace
}  // namespace mjdiag
