#include "mjdiag/render/clip_layout.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr int kLeastWidth = 320;
constexpr int kLeastHeight = 240;
constexpr int kLargestSide = 4096;
constexpr int kLeastPanelWidth = 150;
constexpr int kLeastChartWidth = 150;
constexpr double kResidualShare = 1.7;  // of the residual's width over another chart's
constexpr double kDiagnosisShare = 0.28;  // of the picture's width
constexpr int kLeastDiagnosisWidth = 172;

int Round(double value) { return static_cast<int>(std::lround(value)); }

void CheckSide(const char* name, int side, int least) {
  if (side >= least && side <= kLargestSide && side % 2 == 0) return;
  throw InputError(name, std::to_string(side) + " px",
                   "an even number from " + std::to_string(least) + " to " +
                       std::to_string(kLargestSide) +
                       " (video codecs want even sides)");
}

void CheckCount(const char* what, std::size_t count, std::size_t most, int width) {
  if (count <= most) return;
  throw InputError(what, std::to_string(count) + " side by side",
                   "at most " + std::to_string(most) + " at a width of " +
                       std::to_string(width) + " px");
}

// Columns of equal width with `gap` between them, to the pixel.
cv::Rect Column(const cv::Rect& area, std::size_t index, std::size_t count, int gap) {
  const int n = static_cast<int>(count);
  const int i = static_cast<int>(index);
  const int usable = area.width - gap * (n - 1);
  const int left = area.x + i * gap + usable * i / n;
  const int right = area.x + i * gap + usable * (i + 1) / n;
  return {left, area.y, right - left, area.height};
}

void LayOutHeader(const cv::Rect& header, ClipLayout& layout) {
  const int time_width = Round(9.0 * layout.body.em);
  const int speed_width = Round(8.0 * layout.small.em);
  int x = header.x + layout.margin;
  layout.time = {x, header.y, time_width, header.height};
  x += time_width;
  layout.speed = {x, header.y, speed_width, header.height};
  x += speed_width + layout.margin;
  layout.amplification = {x, header.y, header.br().x - layout.margin - x,
                          header.height};
}

PanelLayout LayOutPanel(const cv::Rect& view, std::size_t traces,
                        const LayoutExtras& extras, const ClipLayout& layout) {
  const int m = layout.margin;
  const int inner = view.width - 2 * m;
  PanelLayout panel;
  panel.view = view;
  panel.title = {view.x + m, view.y + m, inner, Round(1.8 * layout.title.em)};
  int bottom = panel.title.br().y;
  if (extras.ghost) {
    panel.ghost = panel.title + cv::Point(0, panel.title.height + m / 2);
    bottom = panel.ghost.br().y;
  }
  if (extras.legend > 0) {
    const int height = extras.legend * Round(1.5 * layout.small.em) + m / 2;
    panel.legend = {view.x + m, view.br().y - m - height, inner, height};
  }
  if (traces > 0) {
    const int height = static_cast<int>(traces) * layout.line_height + m;
    panel.readout = {view.x + m, bottom + m / 2,
                     std::min(inner, Round(12.2 * layout.body.em)), height};
  }
  return panel;
}

ChartLayout LayOutChart(const cv::Rect& area, const ClipLayout& layout) {
  const int caption_height = Round(1.7 * layout.small.em);
  const int labels_height = Round(1.5 * layout.small.em);
  const int labels_width = Round(3.7 * layout.small.em);
  ChartLayout chart;
  chart.caption = {area.x, area.y, area.width, caption_height};
  chart.value_labels = {area.x, area.y + caption_height, labels_width,
                        area.height - caption_height - labels_height};
  chart.plot = {chart.value_labels.br().x, chart.value_labels.y,
                area.width - labels_width, chart.value_labels.height};
  chart.time_labels = {chart.plot.x, chart.plot.br().y, chart.plot.width,
                       labels_height};
  return chart;
}

// The residual's chart, with room on the right for the names of its limits.
ChartLayout LayOutResidual(const cv::Rect& area, const ClipLayout& layout) {
  const int labels_width = Round(6.2 * layout.small.em);
  ChartLayout chart = LayOutChart(area, layout);
  chart.plot.width -= labels_width;
  chart.time_labels.width -= labels_width;
  chart.level_labels = {chart.plot.br().x, chart.plot.y, labels_width,
                        chart.plot.height};
  return chart;
}

// Takes the residual's part off the left of the area of the charts.
cv::Rect TakeResidual(std::size_t traces, ClipLayout& layout, cv::Rect area) {
  const int gap = 2 * layout.margin;
  const double share = kResidualShare / (kResidualShare + static_cast<double>(traces));
  cv::Rect part = area;
  if (traces > 0) part.width = Round(share * (area.width - gap));
  layout.residual = LayOutResidual(part, layout);
  area.x += part.width + gap;
  area.width -= part.width + gap;
  return area;
}

DiagnosisLayout LayOutDiagnosis(const cv::Rect& area, const ClipLayout& layout) {
  const int m = layout.margin;
  const int inner = area.width - 2 * m;
  const int small_line = Round(1.5 * layout.small.em);
  DiagnosisLayout part;
  part.area = area;
  part.badge = {area.x + m, area.y + m, inner, Round(3.2 * layout.body.em)};
  part.heading = {area.x + m, part.badge.br().y + m / 2, inner, small_line};
  const int bottom = area.br().y - m / 2;
  part.axis_title = {area.x + m, bottom - small_line, inner, small_line};
  part.axis_labels = {area.x + m, part.axis_title.y - small_line, inner, small_line};
  part.rows = {area.x + m, part.heading.br().y, inner,
               part.axis_labels.y - part.heading.br().y};
  return part;
}

}  // namespace

std::size_t MostTraces(int width, bool diagnosis) {
  const double residual = diagnosis ? kResidualShare * kLeastChartWidth : 0.0;
  return static_cast<std::size_t>(std::max(1.0, (width - residual) / kLeastChartWidth));
}

ClipLayout LayOutClip(cv::Size size, std::size_t panels, std::size_t traces,
                      const LayoutExtras& extras) {
  const bool diagnosis = extras.diagnosis;
  CheckSide("width", size.width, kLeastWidth);
  CheckSide("height", size.height, kLeastHeight);
  const int diagnosis_width =
      diagnosis ? std::max(kLeastDiagnosisWidth, Round(kDiagnosisShare * size.width))
                : 0;
  const int views_width = size.width - diagnosis_width;
  CheckCount("runs", panels, static_cast<std::size_t>(views_width / kLeastPanelWidth),
             size.width);
  CheckCount("traces", traces, MostTraces(size.width, diagnosis), size.width);

  // Text shrinks with the picture only as far as it stays readable.
  const double unit = std::min(size.width / 1280.0, size.height / 720.0);
  ClipLayout layout;
  layout.size = size;
  layout.title = {std::max(13.0, 24.0 * unit), Weight::kBold};
  layout.body = {std::max(11.5, 19.0 * unit), Weight::kRegular};
  layout.small = {std::max(10.5, 16.0 * unit), Weight::kRegular};
  layout.margin = std::max(6, Round(12.0 * unit));
  layout.line_height = Round(1.4 * layout.body.em);

  const cv::Rect header(0, 0, size.width, Round(2.1 * layout.body.em));
  LayOutHeader(header, layout);
  const int charts_height = traces > 0 || diagnosis ? Round(0.27 * size.height) : 0;
  layout.charts_area = {0, size.height - charts_height, size.width, charts_height};

  const cv::Rect views(0, header.height, views_width,
                       layout.charts_area.y - header.height);
  if (diagnosis) {
    layout.diagnosis =
        LayOutDiagnosis({views.br().x, views.y, diagnosis_width, views.height}, layout);
  }
  const int gutter = std::max(2, Round(3.0 * unit));
  for (std::size_t i = 0; i < panels; ++i) {
    layout.panels.push_back(
        LayOutPanel(Column(views, i, panels, gutter), traces, extras, layout));
  }
  cv::Rect charts(layout.charts_area.x + layout.margin,
                  layout.charts_area.y + layout.margin / 2,
                  layout.charts_area.width - 2 * layout.margin,
                  layout.charts_area.height - layout.margin);
  if (diagnosis) charts = TakeResidual(traces, layout, charts);
  for (std::size_t i = 0; i < traces; ++i) {
    layout.charts.push_back(
        LayOutChart(Column(charts, i, traces, 2 * layout.margin), layout));
  }
  return layout;
}

cv::Point BaselineIn(const cv::Rect& box, const Font& font) {
  constexpr double kCapitals = 0.72;  // height of capitals [em]
  return {box.x, box.y + Round((box.height + kCapitals * font.em) / 2.0)};
}

}  // namespace mjdiag
