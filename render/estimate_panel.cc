#include "mjdiag/render/estimate_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <string>

#include "mjdiag/render/engineering.h"
#include "mjdiag/render/palette.h"
#include "mjdiag/render/strokes.h"

namespace mjdiag {
namespace {

constexpr double kMostNamesShare = 0.4;  // of the width of the panel
constexpr double kValueHeadroom = 0.25;       // of the axis, beyond the largest deviation
constexpr double kRow = 1.25;            // least height of a row [em]
constexpr double kLeastReach = 1e-3;     // of the axis, if nothing deviates

int Nearest(double value) { return static_cast<int>(std::lround(value)); }

// Whether the interval leaves healthy out.
bool IsOff(const EstimateHistory& history, Eigen::Index at) {
  return std::abs(history.value[at] - history.healthy) > history.half_width[at];
}

// How many half-widths the last estimate lies off healthy; ranks what has a row.
double Significance(const EstimateHistory& history) {
  if (history.value.size() == 0) return 0.0;
  const Eigen::Index last = history.value.size() - 1;
  const double deviation = std::abs(history.value[last] - history.healthy);
  const double significance = deviation / history.half_width[last];
  return std::isfinite(significance) ? significance : 0.0;
}

// The strongest `most` of the estimates, in the order in which they come.
std::vector<std::size_t> Strongest(const std::vector<EstimateHistory>& estimates,
                                   std::size_t most) {
  std::vector<std::size_t> order(estimates.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return Significance(estimates[a]) > Significance(estimates[b]);
  });
  order.resize(std::min(order.size(), most));
  std::sort(order.begin(), order.end());
  return order;
}

// Reaches what is clearly off healthy since the detection. The wide intervals of the
// beginning, and of faults that the motion hardly excites, would leave nothing to see.
ValueRange Axis(const DiagnosisOverlay& overlay) {
  constexpr double kClearly = 2.0;   // half-widths
  constexpr double kFarthest = 3.0;  // times the estimate at the end
  ValueRange axis;
  for (const EstimateHistory& history : overlay.estimates) {
    const Eigen::Index last = history.value.size() - 1;
    if (last < 0 || !IsOff(history, last)) continue;
    const double at_end = std::abs(history.value[last] - history.healthy);
    for (Eigen::Index at = 0; at <= last; ++at) {
      const double deviation = history.value[at] - history.healthy;
      const bool counts =
          at == last || (overlay.estimate_time[at] >= overlay.detection.value_or(0.0) &&
                         std::abs(deviation) > kClearly * history.half_width[at] &&
                         std::abs(deviation) < kFarthest * at_end);
      if (!counts) continue;
      axis.low = std::min(axis.low, deviation);
      axis.high = std::max(axis.high, deviation);
    }
  }
  const double headroom = kValueHeadroom * std::max(axis.high - axis.low, kLeastReach);
  return {axis.low - headroom, axis.high + headroom};
}

std::string ValueText(double value) {
  std::array<char, 64> text{};
  // Six characters at most: columns stay in place.
  const int whole = std::abs(value) >= 10.0 ? (std::abs(value) >= 1000.0 ? 0 : 2) : 3;
  std::snprintf(text.data(), text.size(), "%.*f", whole, std::abs(value));
  return (value < 0.0 ? "\u2212" : "") + std::string(text.data());
}

}  // namespace

EstimatePanel::EstimatePanel(const ClipLayout& layout, const DiagnosisOverlay& overlay,
                             Typesetter& type)
    : place_(*layout.diagnosis),
      title_(layout.title),
      body_(layout.body),
      small_(layout.small),
      margin_(layout.margin),
      overlay_(&overlay),
      axis_(Axis(overlay)) {
  const cv::Rect& rows = place_.rows;
  const int most = std::max(1, Nearest(std::floor(rows.height / (kRow * body_.em))));
  shown_ = Strongest(overlay.estimates, static_cast<std::size_t>(most));
  int names = 0;
  for (const std::size_t index : shown_) {
    names = std::max(names, type.Width(overlay.estimates[index].name, body_));
  }
  const int gap = Nearest(0.5 * body_.em);
  names = std::min(names, Nearest(kMostNamesShare * rows.width)) + gap;
  const int numbers = type.Width("\u22120.000", {body_.em, Weight::kBold}) + gap;
  plot_ = {rows.x + names, rows.y, rows.width - names - numbers, rows.height};
}

cv::Rect EstimatePanel::Row(std::size_t index) const {
  const cv::Rect& rows = place_.rows;
  const auto count = static_cast<int>(std::max<std::size_t>(1, shown_.size()));
  const int n = static_cast<int>(index);
  const int top = rows.y + rows.height * n / count;
  return {rows.x, top, rows.width, rows.y + rows.height * (n + 1) / count - top};
}

double EstimatePanel::Place(double deviation) const {
  const double share = (deviation - axis_.low) / (axis_.high - axis_.low);
  return plot_.x + share * (plot_.width - 1);
}

void EstimatePanel::DrawBackground(Typesetter& type, cv::Mat& picture) const {
  const auto left_out = overlay_->estimates.size() - shown_.size();
  std::string heading = "estimates, 95 % interval";
  if (left_out > 0) heading += ", " + std::to_string(left_out) + " left out";
  type.Draw(type.Fit(heading, place_.heading.width, small_),
            BaselineIn(place_.heading, small_), small_, palette::kInk, picture);

  const int most = std::clamp(Nearest(plot_.width / (3.6 * small_.em)), 2, 5);
  std::vector<double> ticks = RoundTicks(100.0 * axis_.low, 100.0 * axis_.high, most);
  // One number alone gives no scale.
  if (ticks.size() < 2) {
    ticks = RoundTicks(100.0 * axis_.low, 100.0 * axis_.high, 4);
  }
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  const EngineeringFormat format{
      "%", 1.0, std::max(0, Nearest(std::ceil(-std::log10(step) - 1e-6)))};
  int free_from = place_.rows.x;  // numbers that would run into another are left out
  for (const double tick : ticks) {
    const int x = Nearest(Place(tick / 100.0));
    cv::line(picture, {x, plot_.y}, {x, plot_.br().y - 1}, palette::kGrid);
    const std::string text = format.Number(tick);
    const int width = type.Width(text, small_);
    cv::Point origin = BaselineIn(place_.axis_labels, small_);
    origin.x = std::clamp(x - width / 2, place_.rows.x, place_.rows.br().x - width);
    if (origin.x < free_from) continue;
    free_from = origin.x + width + Nearest(0.5 * small_.em);
    type.Draw(text, origin, small_, palette::kQuietInk, picture);
  }
  const std::string quantity =
      type.Fit("off healthy [%]", place_.axis_title.width, small_);
  cv::Point origin = BaselineIn(place_.axis_title, small_);
  origin.x = std::clamp(plot_.x + (plot_.width - type.Width(quantity, small_)) / 2,
                        place_.axis_title.x, place_.axis_title.br().x);
  type.Draw(quantity, origin, small_, palette::kQuietInk, picture);
  cv::rectangle(picture, plot_, palette::kRule);
  const int healthy = Nearest(Place(0.0));
  DrawDashes({healthy, plot_.y + 1}, {healthy, plot_.br().y - 2}, palette::kInk, 1,
             picture);
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    const cv::Rect row = Row(i);
    const std::string& name = overlay_->estimates[shown_[i]].name;
    type.Draw(type.Fit(name, plot_.x - row.x - Nearest(0.5 * body_.em), body_),
              BaselineIn(row, body_), body_, palette::kInk, picture);
  }
}

// Healthy is an outline with a ring, detected is filled with a triangle: shape and word
// say it, not the colour alone.
void EstimatePanel::DrawBadge(double time, Typesetter& type, cv::Mat& picture) const {
  const cv::Rect& box = place_.badge;
  const bool detected = overlay_->detection && *overlay_->detection <= time;
  const cv::Scalar ink = detected ? palette::kPaper : palette::kInk;
  if (detected) {
    cv::rectangle(picture, box, palette::kInk, cv::FILLED);
  } else {
    cv::rectangle(picture, box, palette::kRule, 1);
  }
  const int half = box.height / 2;
  const cv::Point2d middle(box.x + half, box.y + half);
  const double radius = 0.24 * box.height;
  if (detected) {
    const std::vector<cv::Point> triangle{
        {Nearest(middle.x), Nearest(middle.y - radius)},
        {Nearest(middle.x + radius), Nearest(middle.y + 0.8 * radius)},
        {Nearest(middle.x - radius), Nearest(middle.y + 0.8 * radius)}};
    cv::fillConvexPoly(picture, triangle, palette::kWarning, cv::LINE_AA);
  } else {
    DrawDot(middle, radius, palette::kInk, picture);
    DrawDot(middle, 0.7 * radius, palette::kPaper, picture);
  }
  const int x = box.x + box.height;
  const int width = box.width - box.height - margin_ / 2;
  const cv::Rect upper(x, box.y + box.height / 16, width, half);
  const cv::Rect lower(x, box.y + half - box.height / 16, width, half);
  const Font bold{body_.em, Weight::kBold};
  const std::string word = detected ? "detected" : "healthy";
  const std::string note =
      detected ? "at " + DetectionText(*overlay_) : "within limits";
  type.Draw(type.Fit(word, width, bold), BaselineIn(upper, bold), bold, ink, picture);
  type.Draw(type.Fit(note, width, small_), BaselineIn(lower, small_), small_, ink,
            picture);
}

void EstimatePanel::DrawEstimate(const EstimateHistory& history, Eigen::Index at,
                                 const cv::Rect& row, Typesetter& type,
                                 cv::Mat& picture) const {
  const double deviation = history.value[at] - history.healthy;
  const double half = history.half_width[at];
  const bool off = IsOff(history, at);
  const cv::Scalar rgb = off ? palette::OfRun(1) : palette::kQuietInk;
  const double y = row.y + 0.5 * row.height;
  const double left_end = plot_.x + 1.0;
  const double right_end = plot_.br().x - 2.0;
  const double cap = 0.28 * body_.em;
  const double thickness = std::max(1.0, body_.em / 9.0);
  const auto whisker = [&](double value) {
    const double x = Place(value);
    const double inside = std::clamp(x, left_end, right_end);
    DrawCurve({{std::clamp(Place(deviation), left_end, right_end), y}, {inside, y}},
              rgb, thickness, picture);
    if (x == inside) {
      DrawCurve({{x, y - cap}, {x, y + cap}}, rgb, thickness, picture);
      return;
    }
    // Goes on beyond the axis: an arrow.
    const double back = x > inside ? -cap : cap;
    DrawCurve({{inside + back, y - cap}, {inside, y}, {inside + back, y + cap}}, rgb,
              thickness, picture);
  };
  whisker(deviation - half);
  whisker(deviation + half);
  const double x = Place(deviation);
  if (x >= left_end && x <= right_end) {
    DrawDot({x, y}, 0.2 * body_.em, rgb, picture);
    if (!off) DrawDot({x, y}, 0.11 * body_.em, palette::kPaper, picture);
  }
  const Font font{body_.em, off ? Weight::kBold : Weight::kRegular};
  const std::string number = ValueText(history.value[at]);
  cv::Point origin = BaselineIn(row, font);
  origin.x = row.br().x - type.Width(number, font);
  type.Draw(number, origin, font, palette::kInk, picture);
}

void EstimatePanel::DrawAt(double time, Typesetter& type, cv::Mat& picture) const {
  DrawBadge(time, type, picture);
  const std::optional<Eigen::Index> at = EstimateAt(*overlay_, time);
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    const EstimateHistory& history = overlay_->estimates[shown_[i]];
    const cv::Rect row = Row(i);
    if (at && std::isfinite(history.value[*at]) &&
        std::isfinite(history.half_width[*at])) {
      DrawEstimate(history, *at, row, type, picture);
      continue;
    }
    const std::string none = "\u2212";
    cv::Point origin = BaselineIn(row, body_);
    origin.x = row.br().x - type.Width(none, body_);
    type.Draw(none, origin, body_, palette::kQuietInk, picture);
  }
}

}  // namespace mjdiag
