#include "mjdiag/render/view_painter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mjdiag/render/palette.h"
#include "mjdiag/render/scene/image_pixels.h"
#include "mjdiag/render/strokes.h"

namespace mjdiag {

ViewPainter::ViewPainter(std::span<const ClipRun> runs, const ClipLayout& layout,
                         const MachineViews& views)
    : runs_(runs), layout_(layout), views_(views) {}

void ViewPainter::DrawTitle(const cv::Rect& place, std::size_t run, bool is_ghost,
                            Typesetter& type, cv::Mat& picture) const {
  const Font& font = layout_.title;
  const int pad = layout_.margin;
  const int chip = static_cast<int>(std::lround(0.7 * font.em));
  const int text_x = 2 * pad + chip;
  const std::string wanted = runs_[run].title + (is_ghost ? " (ghost)" : "");
  const std::string title = type.Fit(wanted, place.width - text_x - pad, font);
  const cv::Rect box(place.x, place.y, text_x + type.Width(title, font) + pad,
                     place.height);
  DrawBox(box, picture);
  const cv::Scalar rgb = palette::OfRun(run);
  const cv::Rect mark(box.x + pad, box.y + (box.height - chip) / 2, chip, chip);
  cv::rectangle(picture, mark,
                is_ghost ? palette::Tint(rgb, views_.ghost()->opacity) : rgb,
                cv::FILLED);
  if (is_ghost) cv::rectangle(picture, mark, rgb, 1);
  const cv::Rect line(box.x + text_x, box.y, box.width - text_x, box.height);
  type.Draw(title, BaselineIn(line, font), font, palette::kInk, picture);
}

// What lies behind in full colour; a pale rim keeps it apart from the machine.
void ViewPainter::DrawPath(const cv::Rect& view, std::size_t run, double time,
                           const Projection& project, cv::Mat& picture) const {
  const SitePath& path = views_.paths()[run];
  constexpr double kLeastStep = 0.7;  // [px]; shorter ones cost time and show nothing
  std::vector<cv::Point2d> points;
  cv::Point2d end;
  for (std::size_t i = 0; i < path.times.size() && path.times[i] <= time; ++i) {
    const auto pixel = project(path.positions[i]);
    if (!pixel) continue;
    end = {pixel->x(), pixel->y()};
    if (points.empty() || cv::norm(end - points.back()) > kLeastStep) {
      points.push_back(end);
    }
  }
  if (points.empty()) return;
  points.push_back(end);
  cv::Mat part = picture(view);
  const double width = std::max(1.0, std::round(layout_.small.em / 8.0));
  DrawCurve(points, palette::kPaper, width + 2.0, part);
  DrawCurve(points, palette::OfRun(run), width, part);
  DrawDot(points.back(), 1.8 * width + 1.0, palette::kPaper, part);
  DrawDot(points.back(), 1.8 * width, palette::OfRun(run), part);
}

void ViewPainter::DrawLegend(const PanelLayout& panel,
                             std::span<const std::size_t> runs, Typesetter& type,
                             cv::Mat& picture) const {
  const Font& font = layout_.small;
  const int pad = layout_.margin / 2;
  const int sample = static_cast<int>(std::lround(1.5 * font.em));
  const int text_x = 2 * pad + sample;
  std::vector<std::string> texts;
  int width = 0;
  for (const std::size_t run : runs) {
    const std::string name = "path of " + views_.path_site();
    const std::vector<std::string> wordings =
        runs.size() > 1
            ? std::vector{name + ", " + runs_[run].title,
                          views_.path_site() + ", " + runs_[run].title}
            : std::vector{name + ", enlarged as the motion", name + ", enlarged", name};
    std::string text;
    for (const std::string& wording : wordings) {
      text = type.Fit(wording, panel.legend.width - text_x - pad, font);
      if (text == wording) break;
    }
    texts.push_back(text);
    width = std::max(width, type.Width(texts.back(), font));
  }
  DrawBox({panel.legend.x, panel.legend.y, text_x + width + pad, panel.legend.height},
          picture);
  const int line = (panel.legend.height - pad) / static_cast<int>(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const cv::Rect row(panel.legend.x,
                       panel.legend.y + pad / 2 + static_cast<int>(i) * line,
                       panel.legend.width, line);
    const double y = row.y + 0.5 * row.height;
    const double x = row.x + pad;
    const double thick = std::max(1.0, std::round(font.em / 8.0));
    DrawCurve({{x, y}, {x + sample, y}}, palette::OfRun(runs[i]), thick, picture);
    cv::Point origin = BaselineIn(row, font);
    origin.x = row.x + text_x;
    type.Draw(texts[i], origin, font, palette::kInk, picture);
  }
}

void ViewPainter::Paint(std::size_t panel, double time, const RenderedView& rendered,
                        Typesetter& type, cv::Mat& picture) const {
  const PanelLayout& place = layout_.panels[panel];
  const cv::Rect& view = place.view;
  PixelsOf(rendered.picture)(cv::Rect(0, 0, view.width, view.height))
      .copyTo(picture(view));

  const std::size_t run = views_.RunOf(panel);
  std::vector<std::size_t> drawn{run};
  if (views_.ghost()) drawn.insert(drawn.begin(), 0);
  if (!views_.paths().empty()) {
    for (const std::size_t each : drawn) {
      DrawPath(view, each, time, rendered.projection, picture);
    }
    DrawLegend(place, drawn, type, picture);
  }
  DrawTitle(place.title, run, false, type, picture);
  if (views_.ghost()) DrawTitle(place.ghost, 0, true, type, picture);
}

}  // namespace mjdiag
