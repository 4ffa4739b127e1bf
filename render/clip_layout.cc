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
                        const ClipLayout& layout) {
  const int m = layout.margin;
  const int inner = view.width - 2 * m;
  PanelLayout panel;
  panel.view = view;
  panel.title = {view.x + m, view.y + m, inner, Round(1.8 * layout.title.em)};
  if (traces > 0) {
    const int height = static_cast<int>(traces) * layout.line_height + m;
    panel.readout = {view.x + m, panel.title.br().y + m / 2,
                     std::min(inner, Round(11.5 * layout.body.em)), height};
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

}  // namespace

std::size_t MostTraces(int width) {
  return static_cast<std::size_t>(std::max(1, width / kLeastChartWidth));
}

ClipLayout LayOutClip(cv::Size size, std::size_t panels, std::size_t traces) {
  CheckSide("width", size.width, kLeastWidth);
  CheckSide("height", size.height, kLeastHeight);
  CheckCount("runs", panels, static_cast<std::size_t>(size.width / kLeastPanelWidth),
             size.width);
  CheckCount("traces", traces, MostTraces(size.width), size.width);

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
  const int charts_height = traces > 0 ? Round(0.27 * size.height) : 0;
  layout.charts_area = {0, size.height - charts_height, size.width, charts_height};

  const cv::Rect views(0, header.height, size.width,
                       layout.charts_area.y - header.height);
  const int gutter = std::max(2, Round(3.0 * unit));
  for (std::size_t i = 0; i < panels; ++i) {
    layout.panels.push_back(
        LayOutPanel(Column(views, i, panels, gutter), traces, layout));
  }
  const cv::Rect charts(layout.charts_area.x + layout.margin,
                        layout.charts_area.y + layout.margin / 2,
                        layout.charts_area.width - 2 * layout.margin,
                        layout.charts_area.height - layout.margin);
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
