#include "mjdiag/watch/stream/stream_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace mjdiag {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kTick = 1e-3;
constexpr double kDate = 1.7e9;  // s since 1970

/// Twenty seconds of ticks.
/// @param sent, arrived  what a tick takes by these clocks, over what it should
StreamClock Ticked(double sent, double arrived, double offset = 0.0) {
  StreamClock clock(kTick, true);
  for (std::int64_t k = 0; k < 20000; ++k) {
    const double time = static_cast<double>(k) * kTick;
    clock.Add({1, k, kDate + offset + sent * time, kDate + arrived * time});
  }
  return clock;
}

TEST(StreamClockTest, HasNothingToSayOfClocksThatAgree) {
  const StreamClock clock = Ticked(1.0 + 2e-5, 1.0 - 2e-5);
  EXPECT_FALSE(clock.wrong_rate());
  EXPECT_THAT(clock.Notes(), IsEmpty());
  EXPECT_NEAR(clock.report().sent_rate, 2e-5, 1e-6);
}

TEST(StreamClockTest, NoticesTicksOfAnotherRateByTheClockOfTheSender) {
  const StreamClock clock = Ticked(2.0, 2.0);
  EXPECT_TRUE(clock.wrong_rate());
  EXPECT_THAT(clock.Notes(),
              Contains(HasSubstr("every 2.00 ms, the setup says every 1.00 ms")));
}

TEST(StreamClockTest, NoticesTicksOfAnotherRateWithoutAClockOfTheSender) {
  EXPECT_TRUE(Ticked(std::nan(""), 0.5).wrong_rate());
}

TEST(StreamClockTest, SaysThatClocksDrift) {
  const StreamClock clock = Ticked(1.0 + 5e-4, 1.0);
  EXPECT_FALSE(clock.wrong_rate());
  EXPECT_THAT(clock.Notes(), Contains(HasSubstr("differ by 500 ppm")));
}

TEST(StreamClockTest, SaysThatDatesDiffer) {
  EXPECT_THAT(Ticked(1.0, 1.0, -3600.0).Notes(),
              Contains(HasSubstr("behind this one")));
}

TEST(StreamClockTest, AClockThatIsSetIsNoGapAndNoOtherRate) {
  StreamClock clock(kTick, true);
  for (std::int64_t k = 0; k < 20000; ++k) {
    const double time = kDate + static_cast<double>(k) * kTick;
    clock.Add({1, k, time + (k < 10000 ? 0.0 : 120.0), time});
  }
  EXPECT_EQ(clock.report().steps, 1);
  EXPECT_FALSE(clock.wrong_rate());
}

}  // namespace
}  // namespace mjdiag
