#include "mjdiag/render/engineering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/render/typesetter.h"

namespace mjdiag {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

TEST(EngineeringFormat, PicksThePrefixOfThePeak) {
  EXPECT_EQ(FormatForPeak("m", 3.2e-8).unit, "nm");
  EXPECT_EQ(FormatForPeak("m", 6.5e-6).unit, "\u00b5m");
  EXPECT_EQ(FormatForPeak("m", 4e-3).unit, "mm");
  EXPECT_EQ(FormatForPeak("rad", 2.0).unit, "rad");
  EXPECT_EQ(FormatForPeak("m", 0.0).unit, "m");
  EXPECT_EQ(FormatForPeak("1", 1e-6).unit, "1");
}

TEST(EngineeringFormat, ShowsThreeDigitsAtThePeakAndKeepsTheDecimals) {
  const EngineeringFormat format = FormatForPeak("m", 6.5e-6);
  EXPECT_EQ(format.Number(6.5e-6), "6.50");
  EXPECT_EQ(format.Number(-4.2e-8), "\u22120.04");
  EXPECT_EQ(format.Number(-1e-12), "0.00");
  EXPECT_EQ(FormatForPeak("m", 1.234e-4).Number(1.234e-4), "123");
}

TEST(EngineeringFormat, TellsTheResolutionApart) {
  EXPECT_EQ(FormatForResolution("s", 0.25, 6.7e-4).Number(0.1), "100.0");
  EXPECT_EQ(FormatForResolution("s", 2.5, 0.1).Number(0.3), "0.3");
}

TEST(RoundTicks, AreRoundAndInside) {
  EXPECT_THAT(RoundTicks(-0.9, 1.1, 3),
              ElementsAre(DoubleNear(0, 1e-12), DoubleNear(1, 1e-12)));
  EXPECT_THAT(RoundTicks(0.0, 0.25, 6),
              ElementsAre(DoubleNear(0, 1e-12), DoubleNear(0.05, 1e-12),
                          DoubleNear(0.1, 1e-12), DoubleNear(0.15, 1e-12),
                          DoubleNear(0.2, 1e-12), DoubleNear(0.25, 1e-12)));
  for (int most = 2; most < 9; ++most) {
    EXPECT_LE(RoundTicks(-3.3e-7, 8.1e-6, most).size(), static_cast<std::size_t>(most));
  }
}

TEST(GroupedNumber, SeparatesThousandsFromFiveDigitsOn) {
  EXPECT_EQ(GroupedNumber(5000), "5000");
  EXPECT_EQ(GroupedNumber(20000), "20 000");
  EXPECT_EQ(GroupedNumber(1e6), "1 000 000");
  EXPECT_EQ(GroupedNumber(100000), "100 000");
  EXPECT_EQ(GroupedNumber(33.333), "33.3");
}

TEST(Typesetter, CutsTextThatDoesNotFit) {
  Typesetter type;
  const Font font{16.0, Weight::kRegular};
  const std::string text = "Faulty \u00b5 \u00b5 \u00b5";
  EXPECT_EQ(type.Fit(text, type.Width(text, font), font), text);
  const std::string cut = type.Fit(text, 70, font);
  EXPECT_TRUE(cut.ends_with("..."));
  EXPECT_LE(type.Width(cut, font), 70);
}

TEST(Typesetter, StaysWithinTheWidthItAnnounces) {
  Typesetter type;
  const Font font{20.0, Weight::kBold};
  const std::string text = "t = \u22128.25 \u00b5m \u00d75000";
  cv::Mat picture(60, 400, CV_8UC3, cv::Scalar(255, 255, 255));
  type.Draw(text, {20, 40}, font, {0, 0, 0}, picture);
  cv::Mat dark;
  cv::extractChannel(picture < 128, dark, 0);
  int right = 0;
  for (int x = 0; x < dark.cols; ++x) {
    if (cv::countNonZero(dark.col(x)) > 0) right = x;
  }
  const int end = 20 + type.Width(text, font);
  EXPECT_LE(right, end + 1);
  EXPECT_GT(right, end - 8);
}

TEST(FormatForPureNumber, CountsThousandsInsteadOfPrefixes) {
  const EngineeringFormat plain = FormatForPureNumber(12.0, 5.0);
  EXPECT_EQ(plain.unit, "1");
  EXPECT_EQ(plain.Number(10.0), "10");
  const EngineeringFormat large = FormatForPureNumber(21'000.0, 20'000.0);
  EXPECT_EQ(large.unit, "\u00d710^3");
  EXPECT_EQ(large.Number(-20'000.0), "\u221220");
  const EngineeringFormat small = FormatForPureNumber(1.4e-6, 5e-7);
  EXPECT_EQ(small.unit, "\u00d710^\u22126");
  EXPECT_EQ(small.Number(5e-7), "0.5");
  EXPECT_EQ(FormatForPureNumber(0.0, 1.0).unit, "1");
}

}  // namespace
}  // namespace mjdiag
