#pragma once
// Smooth lines and dots on pictures, placed to fractions of a pixel, and boxes for
// text.

#include <opencv2/core.hpp>
#include <vector>

namespace mjdiag {

/// A line through points [px].
void DrawCurve(const std::vector<cv::Point2d>& points, const cv::Scalar& rgb,
               double width, cv::Mat& picture);

/// A filled disc of that radius [px].
void DrawDot(const cv::Point2d& centre, double radius, const cv::Scalar& rgb,
             cv::Mat& picture);

/// A dashed line, horizontal or vertical, from left to right or top to bottom.
void DrawDashes(const cv::Point& from, const cv::Point& to, const cv::Scalar& rgb,
                int width, cv::Mat& picture);

/// Lightens a part of the picture for text; what lies below shines through a little.
void DrawBox(const cv::Rect& box, cv::Mat& picture);

}  // namespace mjdiag
