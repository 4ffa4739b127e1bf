#include "mjdiag/signals/record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Record TwoChannels() {
  Record record(0.5, 10.0);
  record.Add({"x", "m", Eigen::Vector4d(1.0, 2.0, 3.0, 4.0)});
  record.Add({"u", "N", Eigen::Vector4d(5.0, 6.0, 7.0, 8.0)});
  return record;
}

TEST(Record, TimeRunsFromItsStart) {
  const Record record = TwoChannels();
  EXPECT_EQ(record.Time(), Eigen::Vector4d(10.0, 10.5, 11.0, 11.5));
  EXPECT_EQ(record.duration(), 2.0);
}

TEST(Record, SliceKeepsTimeOfItsSamples) {
  const Record slice = TwoChannels().Slice(1, 2);
  EXPECT_EQ(slice.Time(), Eigen::Vector2d(10.5, 11.0));
  EXPECT_EQ(slice.At("u").samples, Eigen::Vector2d(6.0, 7.0));
  EXPECT_EQ(slice.At("x").unit, "m");
}

TEST(Record, KnowsWhichSamplesWereMeasured) {
  Record record = TwoChannels();
  record.Add({"q", "m", Eigen::Vector4d(1.0, 1.5, 2.0, 3.0),
              Eigen::Array4<bool>(true, false, true, true)});
  EXPECT_EQ(record.At("q").Measured(), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(record.At("x").Measured(), record.At("x").samples);
  EXPECT_FALSE(record.Slice(1, 2).At("q").IsMeasured(0));
  EXPECT_EQ(record.Slice(2, 2).At("q").measured.size(), 0);
  EXPECT_EQ(MeasuredOf(record, {"x", "u"}).size(), 0);
  EXPECT_EQ(MeasuredOf(record, {"x", "q"}).count(), 7);
  EXPECT_THROW(record.Add({"v", "m", Eigen::Vector4d::Ones(), SampleMask(3)}),
               InputError);
}

TEST(Record, SliceRefusesSamplesThatAreNotThere) {
  EXPECT_THROW(TwoChannels().Slice(2, 3), InputError);
  EXPECT_THROW(TwoChannels().Slice(-1, 2), InputError);
}

TEST(Record, SaysWhichChannelsItHas) {
  EXPECT_THAT(
      [] { TwoChannels().At("y"); },
      ThrowsMessage<InputError>("record: no channel \"y\"; expected one of x, u"));
  EXPECT_EQ(TwoChannels().Find("y"), nullptr);
}

TEST(Record, GivesTheSamplesOfChannelsInTheOrderOfTheirNames) {
  Eigen::Matrix<double, 2, 4> expected;
  expected << 5.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0, 4.0;
  EXPECT_EQ(SamplesOf(TwoChannels(), {"u", "x"}), expected);
  EXPECT_EQ(SamplesOf(TwoChannels(), {}).rows(), 0);
  EXPECT_THROW(SamplesOf(TwoChannels(), {"u", "y"}), InputError);
}

TEST(Record, RefusesChannelsThatDoNotFit) {
  Record record = TwoChannels();
  EXPECT_THAT(
      [&] {
        record.Add({"x", "m", Eigen::Vector4d::Zero()});
      },
      ThrowsMessage<InputError>(HasSubstr("second channel \"x\"")));
  EXPECT_THAT(
      [&] {
        record.Add({"y", "m", Eigen::Vector3d::Zero()});
      },
      ThrowsMessage<InputError>(HasSubstr("3 samples; expected 4")));
}

TEST(Record, RefusesASampleTimeThatIsNone) {
  EXPECT_THROW(Record(0.0), InputError);
  EXPECT_THROW(Record(-1.0), InputError);
  EXPECT_THROW(Record{NAN}, InputError);
  EXPECT_THROW(Record(1.0, INFINITY), InputError);
}

}  // namespace
}  // namespace mjdiag
