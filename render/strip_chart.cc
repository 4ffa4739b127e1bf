#include "mjdiag/render/strip_chart.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mjdiag/render/palette.h"

namespace mjdiag {
namespace {

constexpr double kHeadroom = 0.08;    // of the value range, above and below
constexpr double kFaint = 0.28;       // share of colour in what is yet to come
constexpr int kFractionBits = 4;      // of a pixel, in OpenCV's drawing calls
constexpr double kLeastSpan = 1e-15;  // value range of a trace that stays at zero

cv::Point FixedPoint(const cv::Point2d& point) {
  constexpr double kOne = 1 << kFractionBits;
  return {static_cast<int>(std::lround(point.x * kOne)),
          static_cast<int>(std::lround(point.y * kOne))};
}

void DrawLine(const std::vector<cv::Point2d>& points, const cv::Scalar& rgb,
              double width, cv::Mat& picture) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const cv::Point2d& point : points) fixed.push_back(FixedPoint(point));
  cv::polylines(picture, fixed, false, rgb, std::max(1, static_cast<int>(width)),
                cv::LINE_AA, kFractionBits);
}

double Spacing(const std::vector<double>& ticks, double otherwise) {
  return ticks.size() > 1 ? ticks[1] - ticks[0] : otherwise;
}

ValueRange WithHeadroom(ValueRange values) {
  const double span = std::max(values.high - values.low, kLeastSpan);
  return {values.low - kHeadroom * span, values.high + kHeadroom * span};
}

}  // namespace

StripChart::StripChart(const ClipLayout& layout, const ChartLayout& place,
                       const Trace& trace, std::span<const Record* const> runs,
                       TimeRange range)
    : place_(place),
      font_(layout.small),
      line_width_(std::max(1.0, std::round(layout.small.em / 8.0))),
      range_(range) {
  const ValueRange data = RangeWithZero(trace, runs, range);
  values_ = WithHeadroom(data);
  const int most =
      std::clamp(static_cast<int>(place.plot.height / (1.9 * font_.em)), 3, 6);
  value_ticks_ = RoundTicks(values_.low, values_.high, most);
  value_format_ = FormatForResolution(trace.unit, std::max(-data.low, data.high),
                                      Spacing(value_ticks_, data.high - data.low));
  caption_ = trace.caption + " [" + value_format_.unit + "]";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    curves_.push_back(MakeCurve(*runs[i], trace.runs[i]));
  }
}

cv::Point2d StripChart::Place(double time, double value) const {
  const cv::Rect& plot = place_.plot;
  const double x = (time - range_.begin) / std::max(range_.end - range_.begin, 1e-12);
  const double y = (values_.high - value) / (values_.high - values_.low);
  return {plot.x + x * (plot.width - 1), plot.y + y * (plot.height - 1)};
}

// Every sample where there are few; else the extremes of each pixel column, in the
// order in which they come, so that no peak is lost.
StripChart::Curve StripChart::MakeCurve(const Record& record,
                                        const Eigen::VectorXd& samples) const {
  const SampleRange within = SamplesWithin(record, range_);
  const auto columns = static_cast<Eigen::Index>(place_.plot.width);
  const Eigen::Index buckets = within.count() <= 2 * columns ? within.count() : columns;
  Curve curve;
  const auto add = [&](Eigen::Index k) {
    const double time =
        record.start_time() + static_cast<double>(k) * record.sample_time();
    curve.times.push_back(time);
    curve.points.push_back(Place(time, samples[k]));
  };
  for (Eigen::Index b = 0; b < buckets; ++b) {
    const Eigen::Index first = within.first + within.count() * b / buckets;
    const Eigen::Index last = within.first + within.count() * (b + 1) / buckets;
    Eigen::Index low = 0;
    Eigen::Index high = 0;
    samples.segment(first, last - first).minCoeff(&low);
    samples.segment(first, last - first).maxCoeff(&high);
    add(first + std::min(low, high));
    if (low != high) add(first + std::max(low, high));
  }
  return curve;
}

void StripChart::DrawValueAxis(Typesetter& type, cv::Mat& picture) const {
  const cv::Rect& plot = place_.plot;
  for (const double tick : value_ticks_) {
    const int y = static_cast<int>(std::lround(Place(range_.begin, tick).y));
    const bool is_zero = std::abs(tick) < 1e-6 * (values_.high - values_.low);
    cv::line(picture, {plot.x, y}, {plot.br().x - 1, y},
             is_zero ? palette::kRule : palette::kGrid);
    const std::string text = value_format_.Number(tick);
    const cv::Rect line(place_.value_labels.x, y - 8, place_.value_labels.width, 17);
    const int gap = static_cast<int>(0.4 * font_.em);
    cv::Point origin = BaselineIn(line, font_);
    origin.x = line.br().x - gap - type.Width(text, font_);
    type.Draw(text, origin, font_, palette::kQuietInk, picture);
  }
}

void StripChart::DrawTimeAxis(Typesetter& type, cv::Mat& picture) const {
  const cv::Rect& labels = place_.time_labels;
  const int most = std::clamp(static_cast<int>(labels.width / (4.5 * font_.em)), 3, 6);
  const std::vector<double> ticks = RoundTicks(range_.begin, range_.end, most);
  const double span = range_.end - range_.begin;
  const EngineeringFormat format =
      FormatForResolution("s", std::max(std::abs(range_.begin), std::abs(range_.end)),
                          Spacing(ticks, span));

  const int unit_width = type.Width(format.unit, font_);
  cv::Point unit_origin = BaselineIn(labels, font_);
  unit_origin.x = labels.br().x - unit_width;
  type.Draw(format.unit, unit_origin, font_, palette::kQuietInk, picture);

  const int gap = static_cast<int>(0.6 * font_.em);
  for (const double tick : ticks) {
    const int x = static_cast<int>(std::lround(Place(tick, 0.0).x));
    cv::line(picture, {x, place_.plot.y}, {x, place_.plot.br().y - 1}, palette::kGrid);
    const std::string text = format.Number(tick);
    const int width = type.Width(text, font_);
    const cv::Point origin(std::max(x - width / 2, labels.x), unit_origin.y);
    // A number that would run into the unit is left out.
    if (origin.x + width + gap > unit_origin.x) continue;
    type.Draw(text, origin, font_, palette::kQuietInk, picture);
  }
}

void StripChart::DrawBackground(Typesetter& type, cv::Mat& picture) const {
  cv::Point origin = BaselineIn(place_.caption, font_);
  origin.x = place_.plot.x;
  const std::string caption = type.Fit(caption_, place_.plot.width, font_);
  type.Draw(caption, origin, font_, palette::kInk, picture);
  DrawTimeAxis(type, picture);
  DrawValueAxis(type, picture);
  for (std::size_t i = curves_.size(); i-- > 0;) {  // the reference run on top
    const cv::Scalar rgb = palette::Tint(palette::OfRun(i), kFaint);
    DrawLine(curves_[i].points, rgb, line_width_, picture);
  }
  cv::rectangle(picture, place_.plot, palette::kRule);
}

void StripChart::DrawUpTo(double time, cv::Mat& picture) const {
  const int x = static_cast<int>(std::lround(Place(time, 0.0).x));
  cv::line(picture, {x, place_.plot.y + 1}, {x, place_.plot.br().y - 2},
           palette::kQuietInk);
  for (std::size_t i = curves_.size(); i-- > 0;) {
    const Curve& curve = curves_[i];
    const auto end = std::upper_bound(curve.times.begin(), curve.times.end(), time);
    const std::vector<cv::Point2d> past(
        curve.points.begin(), curve.points.begin() + (end - curve.times.begin()));
    if (past.empty()) continue;
    const cv::Scalar rgb = palette::OfRun(i);
    DrawLine(past, rgb, line_width_, picture);
    const int radius =
        static_cast<int>(std::lround(1.6 * (1 << kFractionBits) * line_width_));
    cv::circle(picture, FixedPoint(past.back()), radius, rgb, cv::FILLED, cv::LINE_AA,
               kFractionBits);
  }
}

}  // namespace mjdiag
