#include "mjdiag/render/machine_views.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/render/palette.h"
#include "mjdiag/render/strokes.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// How large the largest amplified deviation of a group comes out.
constexpr double kDrawnShare = 0.05;  // of the picture's height
constexpr double kGhostShare = 0.10;  // the same, where it has to be told from a ghost
constexpr double kDrawnAngle = 0.06;  // [rad]
constexpr double kApart = 0.008;      // of the picture's height: worth a ghost
constexpr int kComparedTimes = 100;   // at which poses are compared for the ghost

SceneOptions ViewOptions(const PictureOptions& options, const ClipLayout& layout) {
  // Columns may differ by a pixel; the renderer serves the widest.
  SceneOptions scene{0, layout.panels[0].view.height, options.camera, options.smoothing,
                     options.shadows};
  for (const PanelLayout& panel : layout.panels) {
    scene.width = std::max(scene.width, panel.view.width);
  }
  return scene;
}

void CheckGhost(bool ghost, std::size_t runs) {
  if (!ghost || runs == 2) return;
  throw InputError("ghost", "of " + std::to_string(runs) + " runs",
                   "two: the healthy one and one that differs from it");
}

}  // namespace

MachineViews::MachineViews(const mjModel& model, std::span<const ClipRun> runs,
                           std::span<const Record* const> records, TimeRange range,
                           const PictureOptions& options, const ClipLayout& layout)
    : model_(model),
      runs_(runs),
      records_(records),
      range_(range),
      layout_(layout),
      has_ghost_((CheckGhost(options.ghost, runs.size()), options.ghost)),
      scene_(model, ViewOptions(options, layout)),
      data_(MakeData(model)),
      ghost_data_(MakeData(model)) {
  const double view_height = ViewHeightAtStart();
  const double share = has_ghost_ ? kGhostShare : kDrawnShare;
  amplification_.emplace(DrawnJoints(model), *records[0], records, range,
                         AmplificationOptions{share * view_height, kDrawnAngle,
                                              options.amplify, options.amplify_all});
  if (has_ghost_) FindGhost(view_height);
  const std::optional<int> site = PathSite(model, options.path_site);
  if (!site) return;
  site_ = ElementName(model, mjOBJ_SITE, *site);
  for (const Record* record : records) {
    paths_.push_back(DrawnPath(model, *site, *amplification_, *record, range, *data_));
  }
}

// Of the machine as it truly stands at the first moment, without amplification.
double MachineViews::ViewHeightAtStart() {
  const AmplificationOptions as_is{0.0, 0.0, {}, 1.0};
  const Amplification truth(DrawnJoints(model_), *records_[0], records_, range_, as_is);
  SetPositions(model_, truth.DrawnPositions(*records_[0], range_.begin), *data_);
  return scene_.ViewHeight(*data_);
}

// Bodies that stay together with their ghost in the whole clip have none.
void MachineViews::FindGhost(double view_height) {
  BodyDistances distances(model_);
  for (int i = 0; i <= kComparedTimes; ++i) {
    const double time = range_.begin + (range_.end - range_.begin) * i / kComparedTimes;
    SetPose(runs_.size() - 1, time, *data_);
    SetPose(0, time, *ghost_data_);
    distances.Compare(*data_, *ghost_data_);
  }
  ghost_.bodies = distances.AtLeast(kApart * view_height);
  const cv::Scalar rgb = palette::OfRun(0);
  for (int c = 0; c < 3; ++c) {
    ghost_.rgb[static_cast<std::size_t>(c)] = static_cast<float>(rgb[c] / 255.0);
  }
}

void MachineViews::SetPose(std::size_t run, double time, mjData& data) const {
  SetPositions(model_, amplification_->DrawnPositions(*records_[run], time), data);
}

std::size_t MachineViews::RunOf(std::size_t panel) const {
  return has_ghost_ ? runs_.size() - 1 : panel;
}

void MachineViews::DrawTitle(const cv::Rect& place, std::size_t run, bool is_ghost,
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
  cv::rectangle(picture, mark, is_ghost ? palette::Tint(rgb, ghost_.opacity) : rgb,
                cv::FILLED);
  if (is_ghost) cv::rectangle(picture, mark, rgb, 1);
  const cv::Rect line(box.x + text_x, box.y, box.width - text_x, box.height);
  type.Draw(title, BaselineIn(line, font), font, palette::kInk, picture);
}

// What lies behind in full colour; a pale rim keeps it apart from the machine.
void MachineViews::DrawPath(const cv::Rect& view, std::size_t run, double time,
                            cv::Mat& picture) const {
  const SitePath& path = paths_[run];
  constexpr double kLeastStep = 0.7;  // [px]; shorter ones cost time and show nothing
  std::vector<cv::Point2d> points;
  cv::Point2d end;
  for (std::size_t i = 0; i < path.times.size() && path.times[i] <= time; ++i) {
    const auto pixel = scene_.Project(path.positions[i]);
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

void MachineViews::DrawLegend(const PanelLayout& panel,
                              std::span<const std::size_t> runs, Typesetter& type,
                              cv::Mat& picture) const {
  const Font& font = layout_.small;
  const int pad = layout_.margin / 2;
  const int sample = static_cast<int>(std::lround(1.5 * font.em));
  const int text_x = 2 * pad + sample;
  std::vector<std::string> texts;
  int width = 0;
  for (const std::size_t run : runs) {
    const std::string name = "path of " + site_;
    const std::vector<std::string> wordings =
        runs.size() > 1
            ? std::vector{name + ", " + runs_[run].title,
                          site_ + ", " + runs_[run].title}
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

void MachineViews::Draw(std::size_t panel, double time, Typesetter& type,
                        cv::Mat& picture) {
  const PanelLayout& place = layout_.panels[panel];
  const std::size_t run = RunOf(panel);
  SetPose(run, time, *data_);
  if (has_ghost_) {
    SetPose(0, time, *ghost_data_);
    scene_.Render(*data_, *ghost_data_, ghost_, view_);
  } else {
    scene_.Render(*data_, view_);
  }
  const cv::Mat rendered(view_.height, view_.width, CV_8UC3, view_.rgb.data());
  const cv::Rect& view = place.view;
  rendered(cv::Rect(0, 0, view.width, view.height)).copyTo(picture(view));

  std::vector<std::size_t> drawn{run};
  if (has_ghost_) drawn.insert(drawn.begin(), 0);
  if (!paths_.empty()) {
    for (const std::size_t each : drawn) DrawPath(view, each, time, picture);
    DrawLegend(place, drawn, type, picture);
  }
  DrawTitle(place.title, run, false, type, picture);
  if (has_ghost_) DrawTitle(place.ghost, 0, true, type, picture);
}

}  // namespace mjdiag
