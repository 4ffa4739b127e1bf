#include "mjdiag/watch/stream/tick_decoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mjdiag/watch/stream/packet.h"
#include "watch/taken_ticks.h"

namespace mjdiag {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

class TickDecoderTest : public testing::Test {
 protected:
  std::string Packet(std::int64_t number, std::vector<double> values) {
    std::string bytes;
    AppendPacket({7, number, 1'500'000'000'000'000'000,
                  static_cast<std::uint16_t>(values.size() / 3), 3},
                 values, bytes);
    return bytes;
  }
  void Message(const std::string& bytes) { decoder_.TakeMessage(bytes, 1, 10.0); }

  TickLayout layout_ = test::SmallLayout();
  test::TakenTicks ticks_;
  StreamCounts counts_;
  TickDecoder decoder_{layout_, ticks_, counts_};
};

TEST_F(TickDecoderTest, TakesEveryTickOfAPacketWithItsNumberAndTime) {
  Message(Packet(40, {1, 2, 3, 4, 5, 6}));
  ASSERT_EQ(ticks_.rows.size(), 2U);
  EXPECT_THAT(ticks_.rows[1], ElementsAre(4, 5, 6));
  EXPECT_EQ(ticks_.heads[1].stream, 7U);
  EXPECT_EQ(ticks_.heads[1].number, 41);
  EXPECT_DOUBLE_EQ(ticks_.heads[1].sent, 1.5e9 + 1e-3);
  EXPECT_EQ(ticks_.heads[1].arrived, 10.0);
  EXPECT_EQ(counts_.nonsense, 0);
}

TEST_F(TickDecoderTest, TakesSeveralPacketsOfAMessage) {
  Message(Packet(1, {1, 2, 3}) + Packet(2, {4, 5, 6}));
  EXPECT_EQ(ticks_.rows.size(), 2U);
}

TEST_F(TickDecoderTest, CountsPacketsThatAreNoneAndSaysWhy) {
  std::string wrong_version = Packet(1, {1, 2, 3});
  wrong_version[4] = 9;
  Message(wrong_version);
  EXPECT_THAT(counts_.last_nonsense(), HasSubstr("another version"));
  std::string four;
  AppendPacket({7, 1, 0, 1, 4}, std::vector<double>{1, 2, 3, 4}, four);
  Message(four);
  EXPECT_THAT(counts_.last_nonsense(), HasSubstr("4 channels; expected 3"));
  Message(Packet(1, {1, 2, 3}).substr(0, 40));
  EXPECT_THAT(counts_.last_nonsense(), HasSubstr("40 bytes; expected 56"));
  Message("MJDT");
  Message("");
  Message(std::string("\x01\x02\x00\x03", 4));
  EXPECT_EQ(counts_.nonsense, 6);
  EXPECT_TRUE(ticks_.rows.empty());
}

TEST_F(TickDecoderTest, TakesLinesInTheOrderOfTheSetup) {
  Message("0.5,1,2,3\n0.501,4,,6\r\n");
  ASSERT_EQ(ticks_.rows.size(), 2U);
  EXPECT_THAT(ticks_.rows[0], ElementsAre(1, 2, 3));
  EXPECT_TRUE(std::isnan(ticks_.rows[1][1]));
  EXPECT_EQ(ticks_.heads[1].number - ticks_.heads[0].number, 1);
  EXPECT_EQ(ticks_.heads[1].sent, 0.501);
}

TEST_F(TickDecoderTest, ReadsNamesAndUnitsOfLines) {
  Message("time [ms];u [kN];else;phi [deg];x [um]\n10;2;9;180;5\n11;2;9;90;5\n");
  ASSERT_EQ(ticks_.rows.size(), 2U);
  EXPECT_NEAR(ticks_.rows[0][0], 5e-6, 1e-18);
  EXPECT_DOUBLE_EQ(ticks_.rows[0][1], std::acos(-1.0));
  EXPECT_DOUBLE_EQ(ticks_.rows[0][2], 2000.0);
  EXPECT_DOUBLE_EQ(ticks_.heads[0].sent, 0.01);
  EXPECT_EQ(ticks_.heads[1].number - ticks_.heads[0].number, 1);
}

TEST_F(TickDecoderTest, CountsTicksByTheirColumnWhereThereIsOne) {
  Message("tick,x,phi,u\n17,1,2,3\n");
  ASSERT_EQ(ticks_.heads.size(), 1U);
  EXPECT_EQ(ticks_.heads[0].number, 17);
}

TEST_F(TickDecoderTest, CountsTicksByAClockThatTremblesAndDrifts) {
  // A clock that is 1000 ppm fast gains a whole tick in a thousand.
  double time = 100.0;
  for (int k = 0; k < 3000; ++k) {
    const double tremble = k % 2 == 0 ? 0.0 : 3e-4;
    Message(std::to_string(time + tremble) + ",1,2,3");
    time += 1.001e-3;
  }
  ASSERT_EQ(ticks_.heads.size(), 3000U);
  EXPECT_EQ(ticks_.heads.back().number - ticks_.heads.front().number, 2999);
}

TEST_F(TickDecoderTest, CountsLinesThatAreNoneAndSaysWhy) {
  for (const char* line :
       {"0.5,1,2", "0.5,1,two,3", "x,y,z", "time [s],x [s],phi [rad],u [N]", ",1,2,3",
        "time,x,phi", "\xff\xfe\xfd"}) {
    Message(line);
  }
  EXPECT_EQ(counts_.nonsense, 7);
  EXPECT_TRUE(ticks_.rows.empty());
  Message("0.5,1,two,3");
  EXPECT_THAT(counts_.last_nonsense(), HasSubstr("'two'"));
  // They do not spoil what follows.
  Message("0.5,1,2,3");
  EXPECT_EQ(ticks_.rows.size(), 1U);
}

TEST_F(TickDecoderTest, TakesAStreamThatIsCutAnywhere) {
  const std::string stream = Packet(1, {1, 2, 3, 4, 5, 6}) + "0.5,7,8,9\nnonsense\n" +
                             Packet(3, {10, 11, 12}) + "0.501,13,14,15";
  for (std::size_t cut = 1; cut < stream.size(); ++cut) {
    test::TakenTicks ticks;
    StreamCounts counts;
    TickDecoder decoder(layout_, ticks, counts);
    decoder.TakePart(stream.substr(0, cut), 1.0);
    decoder.TakePart(stream.substr(cut), 2.0);
    decoder.EndStream(3.0);
    ASSERT_EQ(ticks.rows.size(), 5U) << "cut at " << cut;
    EXPECT_THAT(ticks.rows[2], ElementsAre(7, 8, 9));
    EXPECT_THAT(ticks.rows[4], ElementsAre(13, 14, 15));
    EXPECT_EQ(counts.nonsense, 1);
  }
}

TEST_F(TickDecoderTest, FindsItsWayBackInAStreamOfNonsense) {
  std::string broken = Packet(1, {1, 2, 3});
  broken[4] = 2;
  decoder_.TakePart(broken + "\n" + Packet(2, {4, 5, 6}), 1.0);
  EXPECT_GT(counts_.nonsense, 0);
  ASSERT_EQ(ticks_.rows.size(), 1U);
  EXPECT_THAT(ticks_.rows[0], ElementsAre(4, 5, 6));
}

TEST_F(TickDecoderTest, PassesOnThatAReadingIsMissing) {
  Message(Packet(1, {kMissing, 2, 3}));
  ASSERT_EQ(ticks_.rows.size(), 1U);
  EXPECT_TRUE(std::isnan(ticks_.rows[0][0]));
}

}  // namespace
}  // namespace mjdiag
