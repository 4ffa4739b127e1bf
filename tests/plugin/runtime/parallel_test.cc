#include "mjdiag/plugin/runtime/parallel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

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

TEST(ParallelForAll, BeginsEveryTaskAndThrowsWhatTheFirstByNumberDid) {
  std::atomic<int> begun{0};
  const std::string message = test::MessageOf<InputError>([&] {
    ParallelForAll(1000, [&](int i) {
      ++begun;
      if (i % 10 == 7) throw InputError("task", std::to_string(i), "another");
    });
  });
  EXPECT_EQ(message, InputError("task", "7", "another").what());
  EXPECT_EQ(begun, 1000);
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

TEST(ParallelFor, DoesEveryTaskOfNestedLoopsOnce) {
  std::vector<std::atomic<int>> done(1000);
  ParallelFor(10, [&](int i) {
    ParallelFor(10, [&](int j) {
      ParallelFor(10, [&](int k) { ++done.at(100 * i + 10 * j + k); });
    });
  });
  for (const auto& times : done) EXPECT_EQ(times, 1);
}

TEST(ParallelFor, RunsNestedLoopsOnTheSameThreads) {
  std::atomic<int> running{0};
  std::atomic<int> most{0};
  ParallelFor(8, [&](int) {
    ParallelFor(8, [&](int) {
      const int now = ++running;
      int seen = most;
      while (seen < now && !most.compare_exchange_weak(seen, now)) {
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      --running;
    });
  });
  EXPECT_LE(most, static_cast<int>(std::thread::hardware_concurrency()));
}

// A thread that waited for its inner loop and meanwhile began another task of the outer
// one would have two of them under way. On two threads that hardly ever happens.
TEST(ParallelFor, TakesUpNoOtherTaskInTheMiddleOfOne) {
  const tbb::global_control eight(tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena arena(8);
  thread_local bool busy = false;
  std::atomic<int> twice{0};
  arena.execute([&] {
    ParallelFor(50, [&](int) {
      if (busy) ++twice;
      busy = true;
      ParallelFor(
          4, [](int) { std::this_thread::sleep_for(std::chrono::microseconds(200)); });
      busy = false;
    });
  });
  EXPECT_EQ(twice, 0);
}

TEST(ParallelFor, EndsInnerLoopsWhenTheOuterOneFails) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  std::atomic<bool> inside{false};
  std::atomic<int> done{0};
  EXPECT_THROW(
      ParallelFor(2,
                  [&](int i) {
                    if (i == 0) {
                      while (!inside) std::this_thread::yield();
                      throw std::runtime_error("zero");
                    }
                    ParallelFor(100, [&](int) {
                      inside = true;
                      std::this_thread::sleep_for(std::chrono::milliseconds(1));
                      ++done;
                    });
                    EXPECT_EQ(done, 100);
                  }),
      std::runtime_error);
  EXPECT_EQ(done, 100);
}

TEST(ParallelFor, PassesTheExceptionOfAnInnerLoopOn) {
  EXPECT_THROW(ParallelFor(4,
                           [](int i) {
                             ParallelFor(4, [i](int j) {
                               if (i == 2 && j == 2) throw std::runtime_error("inner");
                             });
                           }),
               std::runtime_error);
}

}  // namespace
}  // namespace mjdiag
