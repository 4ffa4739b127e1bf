#include "mjdiag/plugin/runtime/work_time.h"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <thread>

namespace mjdiag {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

TEST(WorkTime, DoesNotCountWhatAProgramWaits) {
  const auto begin = Clock::now();
  const WorkTime time;
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_LT(time.Seconds(), 0.5 * SecondsSince(begin));
}

TEST(WorkTime, IsNeverLongerThanByTheClock) {
  const auto begin = Clock::now();
  const WorkTime time;
  const auto work = [&] {
    while (SecondsSince(begin) < 0.05) {
    }
  };
  std::thread other(work);
  work();
  other.join();
  const double worked = time.Seconds();
  EXPECT_GT(worked, 0.0);
  EXPECT_LE(worked, SecondsSince(begin));
}

TEST(AfterWork, IsNotOverWhileAProgramWaits) {
  const auto is_over = AfterWork(0.1);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(is_over());
  const WorkTime time;
  while (time.Seconds() < 0.15) {
  }
  EXPECT_TRUE(is_over());
  EXPECT_FALSE(AfterWork(std::nullopt)());
}

}  // namespace
}  // namespace mjdiag
