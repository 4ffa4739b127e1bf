#include "mjdiag/render/strip_chart.h"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgproc.hpp>

#include "mjdiag/render/palette.h"
#include "render/test_machine.h"

namespace mjdiag {
namespace {

class Strip : public ::testing::TestWithParam<cv::Size> {
 protected:
  StripChart Make(const StripMarks& marks) {
    const Channel& residual = overlay_.residual.channels()[0];
    const Trace trace{"residual", "residual", "1", {residual.samples}};
    const std::array<const Record*, 1> runs{&overlay_.residual};
    return {layout_, *layout_.residual, trace, runs, {0.0, 0.1}, marks};
  }
  cv::Mat Paint(const StripMarks& marks, double time) {
    StripChart chart = Make(marks);
    cv::Mat picture(layout_.size, CV_8UC3, palette::kPaper);
    chart.DrawBackground(type_, picture);
    chart.DrawUpTo(time, type_, picture);
    return picture;
  }
  StripMarks Marks() const {
    return {{{2.5, "upper limit"}, {-1.5, "lower limit"}},
            overlay_.detection,
            "detected at 0.041 s",
            1};
  }
  double Change(const cv::Mat& a, const cv::Mat& b, const cv::Rect& part) {
    return cv::norm(a(part), b(part), cv::NORM_INF);
  }

  const ClipLayout layout_ = LayOutClip(GetParam(), 2, 2, {true, false, 1});
  const DiagnosisOverlay overlay_ = test::Overlay();
  Typesetter type_;
};

TEST_P(Strip, MarksTheMomentFromThenOnOnly) {
  StripMarks unmarked = Marks();
  unmarked.moment.reset();
  const cv::Rect whole({0, 0}, layout_.size);
  EXPECT_EQ(Change(Paint(Marks(), 0.0409), Paint(unmarked, 0.0409), whole), 0.0);
  const cv::Mat with = Paint(Marks(), 0.0411);
  const cv::Mat without = Paint(unmarked, 0.0411);
  EXPECT_GT(Change(with, without, layout_.residual->caption), 100.0);
  // Still there later, while the cursor has moved on.
  EXPECT_GT(Change(Paint(Marks(), 0.09), Paint(unmarked, 0.09), layout_.residual->plot),
            100.0);
}

TEST_P(Strip, DrawsEveryLimitDashedAndNamed) {
  StripMarks none = Marks();
  none.levels.clear();
  const cv::Rect& plot = layout_.residual->plot;
  const cv::Mat with = Paint(Marks(), 0.0);
  cv::Mat grey;
  cv::cvtColor(with, grey, cv::COLOR_RGB2GRAY);
  // Rows that are dark for a good part of the width, but not for all of it.
  int dashed = 0;
  for (int y = plot.y + 2; y < plot.br().y - 2; ++y) {
    const cv::Mat row = grey(cv::Rect(plot.x + 2, y, plot.width - 4, 1));
    const double dark = cv::countNonZero(row < 80) / static_cast<double>(row.cols);
    dashed += dark > 0.4 && dark < 0.8 ? 1 : 0;
  }
  EXPECT_EQ(dashed, 2);
  EXPECT_GT(Change(with, Paint(none, 0.0), layout_.residual->level_labels), 100.0);
}

TEST_P(Strip, KeepsNamesOfCloseLimitsApart) {
  StripMarks close = Marks();
  close.levels = {{0.010, "upper limit"}, {0.0, "lower limit"}};
  const cv::Mat picture = Paint(close, 0.0);
  cv::Mat grey;
  cv::cvtColor(picture, grey, cv::COLOR_RGB2GRAY);
  const cv::Rect& column = layout_.residual->level_labels;
  // Two lines of text with an empty row between them.
  int lines = 0;
  bool in_line = false;
  for (int y = column.y - 4; y < column.br().y + 4; ++y) {
    const cv::Mat row = grey(cv::Rect(column.x + 2, y, column.width - 2, 1));
    const bool dark = cv::countNonZero(row < 200) > 0;
    lines += dark && !in_line ? 1 : 0;
    in_line = dark;
  }
  EXPECT_EQ(lines, 2);
}

TEST_P(Strip, PaintsInsideItsBoxesOnly) {
  const cv::Mat picture = Paint(Marks(), 0.09);
  const ChartLayout& place = *layout_.residual;
  cv::Mat outside = picture.clone();
  for (const cv::Rect& box : {place.caption, place.plot, place.value_labels,
                              place.time_labels, place.level_labels}) {
    outside(box).setTo(palette::kPaper);
  }
  // The outermost number of the value axis may stand half a line above its box.
  const cv::Mat paper(layout_.size, CV_8UC3, palette::kPaper);
  EXPECT_EQ(cv::norm(outside, paper, cv::NORM_INF), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Strip,
                         ::testing::Values(cv::Size(1280, 720), cv::Size(640, 360)));

}  // namespace
}  // namespace mjdiag
