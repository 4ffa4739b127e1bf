#include "mjdiag/render/strip_chart.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "mjdiag/render/palette.h"
#include "mjdiag/render/strokes.h"

namespace mjdiag {
namespace {

constexpr double kHeadroom = 0.08;    // of the value range, above and below
constexpr double kFaint = 0.28;       // share of colour in what is yet to come
constexpr double kLeastSpan = 1e-15;  // value range of a trace that stays at zero

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
                       TimeRange range, StripMarks marks)
    : place_(place),
      font_(layout.small),
      line_width_(std::max(1.0, std::round(layout.small.em / 8.0))),
      range_(range),
      marks_(std::move(marks)) {
  ValueRange data = RangeWithZero(trace, runs, range);
  for (const StripMarks::Level& level : marks_.levels) {
    data = {std::min(data.low, level.value), std::max(data.high, level.value)};
  }
  values_ = WithHeadroom(data);
  const int most =
      std::clamp(static_cast<int>(place.plot.height / (1.9 * font_.em)), 3, 6);
  value_ticks_ = RoundTicks(values_.low, values_.high, most);
  const double peak = std::max(-data.low, data.high);
  const double step = Spacing(value_ticks_, data.high - data.low);
  value_format_ = trace.unit == "1" ? FormatForPureNumber(peak, step)
                                    : FormatForResolution(trace.unit, peak, step);
  unit_ = " [" + value_format_.unit + "]";
  caption_ = trace.caption;
  short_caption_ = trace.name;
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

std::string StripChart::Caption(Typesetter& type) const {
  const int width = place_.plot.width;
  std::string full = caption_ + unit_;
  if (type.Width(full, font_) <= width) return full;
  return type.Fit(short_caption_ + unit_, width, font_);
}

void StripChart::DrawBackground(Typesetter& type, cv::Mat& picture) {
  cv::Point origin = BaselineIn(place_.caption, font_);
  origin.x = place_.plot.x;
  type.Draw(Caption(type), origin, font_, palette::kInk, picture);
  DrawTimeAxis(type, picture);
  DrawValueAxis(type, picture);
  cv::Mat past = picture.clone();
  DrawCurves(1.0, past);
  DrawCurves(kFaint, picture);
  for (cv::Mat* part : {&past, &picture}) {
    DrawLevels(type, *part);
    cv::rectangle(*part, place_.plot, palette::kRule);
  }
  past_ = past(place_.plot).clone();
}

void StripChart::DrawCurves(double share, cv::Mat& picture) const {
  for (std::size_t i = curves_.size(); i-- > 0;) {  // the reference run on top
    const cv::Scalar rgb =
        palette::Tint(palette::OfRun(marks_.first_colour + i), share);
    DrawCurve(curves_[i].points, rgb, line_width_, picture);
  }
}

void StripChart::DrawLevels(Typesetter& type, cv::Mat& picture) const {
  if (marks_.levels.empty()) return;
  const cv::Rect& column = place_.level_labels;
  const int line = static_cast<int>(std::lround(1.2 * font_.em));
  std::vector<StripMarks::Level> levels = marks_.levels;
  std::sort(levels.begin(), levels.end(),
            [](const auto& a, const auto& b) { return a.value > b.value; });
  int top = column.y;  // names of limits that lie close move apart
  int left = static_cast<int>(levels.size());
  for (const StripMarks::Level& level : levels) {
    const int y = static_cast<int>(std::lround(Place(range_.begin, level.value).y));
    DrawDashes({place_.plot.x, y}, {place_.plot.br().x - 1, y}, palette::kInk, 1,
               picture);
    const int bottom = column.br().y - left-- * line;  // leaves room for those below
    const int name_top = std::max(top, std::min(y - line / 2, bottom));
    const cv::Rect box(column.x + static_cast<int>(0.3 * font_.em), name_top,
                       column.width - static_cast<int>(0.3 * font_.em), line);
    type.Draw(type.Fit(level.name, box.width, font_), BaselineIn(box, font_), font_,
              palette::kInk, picture);
    top = name_top + line;
  }
}

// A line of its own weight, and in the caption's line what it means.
void StripChart::DrawMoment(Typesetter& type, cv::Mat& picture) const {
  const cv::Rect& plot = place_.plot;
  const double x = Place(*marks_.moment, 0.0).x;
  const int width = static_cast<int>(line_width_);
  cv::line(picture, {static_cast<int>(std::lround(x)), plot.y + 1},
           {static_cast<int>(std::lround(x)), plot.br().y - 2}, palette::kInk, width);
  const int right =
      place_.level_labels.empty() ? plot.br().x : place_.level_labels.br().x;
  cv::Point origin = BaselineIn(place_.caption, font_);
  const int from =
      plot.x + type.Width(Caption(type), font_) + static_cast<int>(font_.em);
  const std::string name = type.Fit(marks_.moment_name, right - from, font_);
  origin.x = right - type.Width(name, font_);
  type.Draw(name, origin, {font_.em, Weight::kBold}, palette::kInk, picture);
}

void StripChart::DrawUpTo(double time, Typesetter& type, cv::Mat& picture) const {
  // What is past lies ready: only the part left of the present is copied.
  const cv::Rect& plot = place_.plot;
  const int x = static_cast<int>(std::lround(Place(time, 0.0).x));
  const cv::Rect past(0, 0, std::clamp(x - plot.x, 0, plot.width), plot.height);
  if (!past.empty()) past_(past).copyTo(picture(past + plot.tl()));
  if (marks_.moment && *marks_.moment >= range_.begin && *marks_.moment <= time) {
    DrawMoment(type, picture);
  }
  cv::line(picture, {x, plot.y + 1}, {x, plot.br().y - 2}, palette::kQuietInk);
  for (std::size_t i = curves_.size(); i-- > 0;) {
    const Curve& curve = curves_[i];
    const auto after = std::upper_bound(curve.times.begin(), curve.times.end(), time);
    if (after == curve.times.begin()) continue;
    const auto last = static_cast<std::size_t>(after - curve.times.begin()) - 1;
    DrawDot(curve.points[last], 1.6 * line_width_,
            palette::OfRun(marks_.first_colour + i), picture);
  }
}

}  // namespace mjdiag
