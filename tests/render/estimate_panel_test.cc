#include "mjdiag/render/estimate_panel.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "mjdiag/render/palette.h"
#include "render/test_machine.h"

namespace mjdiag {
namespace {

class EstimatePanelAt : public ::testing::TestWithParam<cv::Size> {
 protected:
  cv::Mat Paint(const DiagnosisOverlay& overlay, double time) {
    const EstimatePanel panel(layout_, overlay, type_);
    cv::Mat picture(layout_.size, CV_8UC3, palette::kPaper);
    panel.DrawBackground(type_, picture);
    panel.DrawAt(time, type_, picture);
    return picture;
  }
  cv::Mat Grey(const cv::Mat& picture) {
    cv::Mat grey;
    cv::cvtColor(picture, grey, cv::COLOR_RGB2GRAY);
    return grey;
  }
  /// The part of the rows in which fault `index` of `count` is shown.
  cv::Rect Row(int index, int count) const {
    const cv::Rect& rows = layout_.diagnosis->rows;
    const int top = rows.y + rows.height * index / count;
    return {rows.x, top, rows.width, rows.y + rows.height * (index + 1) / count - top};
  }

  const ClipLayout layout_ = LayOutClip(GetParam(), 2, 2, {true, false, 1});
  Typesetter type_;
};

TEST_P(EstimatePanelAt, ChangesItsBadgeAtTheMomentOfDetectionEvenInGrey) {
  const DiagnosisOverlay overlay = test::Overlay();
  const cv::Rect badge = layout_.diagnosis->badge;
  const cv::Mat early = Grey(Paint(overlay, 0.0)(badge));
  const cv::Mat before = Grey(Paint(overlay, 0.0409)(badge));
  const cv::Mat after = Grey(Paint(overlay, 0.041)(badge));
  EXPECT_EQ(cv::norm(early, before, cv::NORM_INF), 0.0);
  // Paper becomes ink, not only one colour another.
  EXPECT_GT(cv::norm(before, after, cv::NORM_L1), 100.0 * badge.area());
}

TEST_P(EstimatePanelAt, StaysHealthyWithoutADetection) {
  DiagnosisOverlay overlay = test::Overlay();
  overlay.detection.reset();
  const cv::Rect badge = layout_.diagnosis->badge;
  EXPECT_EQ(
      cv::norm(Paint(overlay, 0.0)(badge), Paint(overlay, 0.1)(badge), cv::NORM_INF),
      0.0);
}

TEST_P(EstimatePanelAt, PaintsInsideItsAreaOnly) {
  const cv::Mat picture = Paint(test::Overlay(), 0.05);
  cv::Mat outside = picture.clone();
  outside(layout_.diagnosis->area).setTo(palette::kPaper);
  const cv::Mat paper(layout_.size, CV_8UC3, palette::kPaper);
  EXPECT_EQ(cv::norm(outside, paper, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(picture, paper, cv::NORM_INF), 0.0);
}

TEST_P(EstimatePanelAt, ShowsWhichEstimateIsOffHealthyBesideItsColour) {
  // A hair more of interval takes healthy in: the mark becomes hollow, the number thin.
  DiagnosisOverlay off = test::Overlay();
  off.estimates.resize(1);
  off.estimates.push_back(off.estimates[0]);
  off.estimates[0].half_width.setConstant(0.1999);
  DiagnosisOverlay healthy = off;
  healthy.estimates[0].half_width.setConstant(0.2001);
  const cv::Rect row = Row(0, 2);
  cv::Mat change;
  cv::absdiff(Grey(Paint(off, 0.1)(row)), Grey(Paint(healthy, 0.1)(row)), change);
  EXPECT_GT(cv::countNonZero(change > 50), 10);
}

TEST_P(EstimatePanelAt, LeavesTheRowOfAnUndeterminedFaultWithoutAMark) {
  DiagnosisOverlay overlay = test::Overlay();
  const cv::Mat with = Paint(overlay, 0.1);
  const cv::Rect row = Row(2, 3);
  DiagnosisOverlay none = overlay;
  none.estimate_time.array() += 1.0;  // nothing known yet
  // The row looks as it does before there is any estimate.
  EXPECT_EQ(cv::norm(with(row), Paint(none, 0.1)(row), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(with(Row(0, 3)), Paint(none, 0.1)(Row(0, 3)), cv::NORM_INF), 50.0);
}

TEST_P(EstimatePanelAt, ShowsTheStrongestOfMoreFaultsThanFit) {
  DiagnosisOverlay overlay = test::Overlay();
  const EstimateHistory strong = overlay.estimates[0];
  const EstimateHistory weak = overlay.estimates[1];
  overlay.estimates.assign(100, weak);
  overlay.estimates[70] = strong;
  const cv::Mat picture = Paint(overlay, 0.1);
  const cv::Rect rows = layout_.diagnosis->rows;
  // Another name for a fault is seen only if the fault has a row.
  const auto change = [&](std::size_t index) {
    DiagnosisOverlay other = overlay;
    other.estimates[index].name = "zzzzzzz";
    return cv::norm(picture(rows), Paint(other, 0.1)(rows), cv::NORM_INF);
  };
  EXPECT_GT(change(70), 50.0);
  EXPECT_EQ(change(69), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, EstimatePanelAt,
                         ::testing::Values(cv::Size(1280, 720), cv::Size(640, 360)));

}  // namespace
}  // namespace mjdiag
