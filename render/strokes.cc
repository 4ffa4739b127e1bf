#include "mjdiag/render/strokes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mjdiag/render/palette.h"

namespace mjdiag {
namespace {

constexpr int kFractionBits = 4;  // of a pixel, in OpenCV's drawing calls
constexpr double kOne = 1 << kFractionBits;
constexpr int kDash = 6;  // [px]
constexpr int kGap = 4;   // [px]

cv::Point FixedPoint(const cv::Point2d& point) {
  return {static_cast<int>(std::lround(point.x * kOne)),
          static_cast<int>(std::lround(point.y * kOne))};
}

}  // namespace

void DrawCurve(const std::vector<cv::Point2d>& points, const cv::Scalar& rgb,
               double width, cv::Mat& picture) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const cv::Point2d& point : points) fixed.push_back(FixedPoint(point));
  cv::polylines(picture, fixed, false, rgb, std::max(1, static_cast<int>(width)),
                cv::LINE_AA, kFractionBits);
}

void DrawDot(const cv::Point2d& centre, double radius, const cv::Scalar& rgb,
             cv::Mat& picture) {
  cv::circle(picture, FixedPoint(centre), static_cast<int>(std::lround(radius * kOne)),
             rgb, cv::FILLED, cv::LINE_AA, kFractionBits);
}

void DrawDashes(const cv::Point& from, const cv::Point& to, const cv::Scalar& rgb,
                int width, cv::Mat& picture) {
  const bool horizontal = from.y == to.y;
  const int length = horizontal ? to.x - from.x : to.y - from.y;
  for (int at = 0; at <= length; at += kDash + kGap) {
    const int end = std::min(at + kDash - 1, length);
    const auto point = [&](int along) {
      return horizontal ? cv::Point(from.x + along, from.y)
                        : cv::Point(from.x, from.y + along);
    };
    cv::line(picture, point(at), point(end), rgb, width);
  }
}

void DrawBox(const cv::Rect& box, cv::Mat& picture) {
  constexpr double kOpacity = 0.82;
  cv::Mat part = picture(box);
  part = part * (1.0 - kOpacity) + palette::kPaper * kOpacity;
}

}  // namespace mjdiag
