#include "mjdiag/render/clip_painter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mjdiag/plugin/mujoco_model.h"
#include "mjdiag/render/amplification_label.h"
#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/render/engineering.h"
#include "mjdiag/render/palette.h"
#include "mjdiag/render/strip_chart.h"
#include "mjdiag/render/trace.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// How large the largest amplified deviation of a group comes out.
constexpr double kDrawnShare = 0.05;  // of the picture's height
constexpr double kDrawnAngle = 0.06;  // [rad]
constexpr double kBoxOpacity = 0.82;

std::vector<const Record*> Records(std::span<const ClipRun> runs) {
  if (runs.empty()) throw InputError("clip", "no runs", "at least one");
  std::vector<const Record*> records;
  for (const ClipRun& run : runs) {
    if (run.record == nullptr || run.record->samples() == 0) {
      throw InputError("run \"" + run.title + "\"", "no samples", "a record");
    }
    records.push_back(run.record);
  }
  return records;
}

double LastTime(const Record& record) {
  return record.start_time() + record.duration() - record.sample_time();
}

TimeRange ShownRange(std::span<const Record* const> records,
                     const PictureOptions& options) {
  TimeRange common{records[0]->start_time(), LastTime(*records[0])};
  for (const Record* record : records) {
    common.begin = std::max(common.begin, record->start_time());
    common.end = std::min(common.end, LastTime(*record));
  }
  const TimeRange range{options.begin.value_or(common.begin),
                        options.end.value_or(common.end)};
  const double slack = 1e-9 + records[0]->sample_time();
  if (!(range.begin >= common.begin - slack && range.end <= common.end + slack &&
        range.begin < range.end)) {
    throw InputError(
        "time range",
        std::to_string(range.begin) + " to " + std::to_string(range.end) + " s",
        "begin before end, within " + std::to_string(common.begin) + " to " +
            std::to_string(common.end) + " s");
  }
  return range;
}

std::vector<Trace> ShownTraces(std::span<const Record* const> records,
                               const PictureOptions& options) {
  std::vector<std::string> axes = options.axes;
  if (axes.empty()) {
    axes = TrackedAxes(*records[0]);
    axes.resize(std::min(axes.size(), MostTraces(options.width)));
  }
  return TrackingErrors(records, axes);
}

AmplificationOptions ChooseAmplification(const PictureOptions& options,
                                         double view_height) {
  return {kDrawnShare * view_height, kDrawnAngle, options.amplify, options.amplify_all};
}

std::string SpeedText(double speed) {
  if (speed == 0.0) return "";
  if (speed == 1.0) return "real time";
  if (speed > 1.0) return GroupedNumber(speed) + "\u00d7 faster";
  return GroupedNumber(1.0 / speed) + "\u00d7 slower";
}

// Lets what lies below shine through a little.
void DrawBox(const cv::Rect& box, cv::Mat& picture) {
  cv::Mat part = picture(box);
  part = part * (1.0 - kBoxOpacity) + palette::kPaper * kBoxOpacity;
}

SceneOptions ViewOptions(const PictureOptions& options, const ClipLayout& layout) {
  // Columns may differ by a pixel; the renderer serves the widest.
  SceneOptions scene{0, layout.panels[0].view.height, options.camera, options.smoothing,
                     options.shadows};
  for (const PanelLayout& panel : layout.panels) {
    scene.width = std::max(scene.width, panel.view.width);
  }
  return scene;
}

}  // namespace

struct ClipPainter::State {
  State(const mjModel& source, std::span<const ClipRun> clip_runs,
        const PictureOptions& options, double clip_speed, double time_step)
      : model(source),
        runs(clip_runs.begin(), clip_runs.end()),
        records(Records(clip_runs)),
        range(ShownRange(records, options)),
        traces(ShownTraces(records, options)),
        layout(LayOutClip({options.width, options.height}, runs.size(), traces.size())),
        scene(source, ViewOptions(options, layout)),
        data(MakeData(source)),
        amplification(DrawnJoints(source), *records[0], records, range,
                      ChooseAmplification(options, ViewHeightAtStart())),
        speed(SpeedText(clip_speed)),
        clock(FormatForResolution(
            "s", std::max(std::abs(range.begin), std::abs(range.end)), time_step)) {
    for (const Trace& trace : traces) readout_formats.push_back(ReadoutFormat(trace));
    for (std::size_t i = 0; i < traces.size(); ++i) {
      charts.emplace_back(layout, layout.charts[i], traces[i], records, range);
    }
    DrawBackground();
  }

  // The machine as it truly stands at the first moment, without amplification.
  double ViewHeightAtStart() {
    const AmplificationOptions as_is{0.0, 0.0, {}, 1.0};
    const Amplification truth(DrawnJoints(model), *records[0], records, range, as_is);
    SetPositions(model, truth.DrawnPositions(*records[0], range.begin), *data);
    return scene.ViewHeight(*data);
  }

  EngineeringFormat ReadoutFormat(const Trace& trace) const {
    const ValueRange values = RangeWithZero(trace, records, range);
    return FormatForPeak(trace.unit, std::max(-values.low, values.high));
  }

  void DrawBackground() {
    background.create(layout.size, CV_8UC3);
    background.setTo(palette::kPaper);
    type.Draw(speed, BaselineIn(layout.speed, layout.small), layout.small,
              palette::kQuietInk, background);
    DrawAmplification();
    for (const StripChart& chart : charts) chart.DrawBackground(type, background);
  }

  void DrawAmplification() {
    const cv::Rect& box = layout.amplification;
    std::string text;
    for (const std::string& label : AmplificationLabels(amplification)) {
      text = type.Fit(label, box.width, layout.small);
      if (text == label) break;
    }
    cv::Point origin = BaselineIn(box, layout.small);
    origin.x = box.br().x - type.Width(text, layout.small);
    type.Draw(text, origin, layout.small, palette::kInk, background);
  }

  void DrawView(std::size_t run, double time, cv::Mat& picture) {
    SetPositions(model, amplification.DrawnPositions(*records[run], time), *data);
    scene.Render(*data, view);
    const cv::Mat rendered(view.height, view.width, CV_8UC3, view.rgb.data());
    const cv::Rect& place = layout.panels[run].view;
    rendered(cv::Rect(0, 0, place.width, place.height)).copyTo(picture(place));
  }

  void DrawTitle(std::size_t run, cv::Mat& picture) {
    const cv::Rect& place = layout.panels[run].title;
    const int pad = layout.margin;
    const int chip = static_cast<int>(std::lround(0.7 * layout.title.em));
    const int text_x = 2 * pad + chip;
    const std::string title =
        type.Fit(runs[run].title, place.width - text_x - pad, layout.title);
    const cv::Rect box(place.x, place.y, text_x + type.Width(title, layout.title) + pad,
                       place.height);
    DrawBox(box, picture);
    cv::rectangle(picture,
                  cv::Rect(box.x + pad, box.y + (box.height - chip) / 2, chip, chip),
                  palette::OfRun(run), cv::FILLED);
    const cv::Rect line(box.x + text_x, box.y, box.width - text_x, box.height);
    type.Draw(title, BaselineIn(line, layout.title), layout.title, palette::kInk,
              picture);
  }

  void DrawReadout(std::size_t run, double time, cv::Mat& picture) {
    const cv::Rect& box = layout.panels[run].readout;
    if (box.empty()) return;
    DrawBox(box, picture);
    for (std::size_t i = 0; i < traces.size(); ++i) {
      const int y =
          box.y + layout.margin / 2 + static_cast<int>(i) * layout.line_height;
      DrawReading(
          traces[i], readout_formats[i], run, time,
          {box.x + layout.margin, y, box.width - 2 * layout.margin, layout.line_height},
          picture);
    }
  }

  // Name left, number right-aligned before its unit, so that digits stay in place.
  void DrawReading(const Trace& trace, const EngineeringFormat& format, std::size_t run,
                   double time, const cv::Rect& line, cv::Mat& picture) {
    const Font& font = layout.body;
    const cv::Point baseline = BaselineIn(line, font);
    const int unit_x = line.br().x - static_cast<int>(std::lround(2.9 * font.em));
    const std::string number =
        format.Number(TraceValue(trace, run, *records[run], time));
    const int number_x = unit_x - static_cast<int>(std::lround(0.4 * font.em)) -
                         type.Width(number, font);
    const std::string name = type.Fit(trace.name, number_x - line.x, font);
    type.Draw(name, baseline, font, palette::kInk, picture);
    type.Draw(number, {number_x, baseline.y}, font, palette::kInk, picture);
    type.Draw(format.unit, {unit_x, baseline.y}, font, palette::kQuietInk, picture);
  }

  void DrawClock(double time, cv::Mat& picture) {
    const Font font{layout.body.em, Weight::kBold};
    const std::string text = "t = " + clock.Number(time) + " " + clock.unit;
    type.Draw(type.Fit(text, layout.time.width, font), BaselineIn(layout.time, font),
              font, palette::kInk, picture);
  }

  const mjModel& model;
  std::vector<ClipRun> runs;
  std::vector<const Record*> records;
  TimeRange range;
  std::vector<Trace> traces;
  ClipLayout layout;
  SceneRenderer scene;
  DataPtr data;
  Amplification amplification;
  std::string speed;
  EngineeringFormat clock;
  std::vector<EngineeringFormat> readout_formats;
  std::vector<StripChart> charts;
  Typesetter type;
  cv::Mat background;
  Image view;
};

ClipPainter::ClipPainter(const mjModel& model, std::span<const ClipRun> runs,
                         const PictureOptions& options, double speed, double time_step)
    : state_(std::make_unique<State>(model, runs, options, speed, time_step)) {}

ClipPainter::~ClipPainter() = default;

TimeRange ClipPainter::range() const { return state_->range; }
const ClipLayout& ClipPainter::layout() const { return state_->layout; }

void ClipPainter::Paint(double time, Image& picture) {
  State& s = *state_;
  picture.width = s.layout.size.width;
  picture.height = s.layout.size.height;
  picture.rgb.resize(3 * static_cast<std::size_t>(picture.width) * picture.height);
  cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.rgb.data());
  s.background.copyTo(canvas);
  s.DrawClock(time, canvas);
  for (std::size_t run = 0; run < s.runs.size(); ++run) {
    s.DrawView(run, time, canvas);
    s.DrawTitle(run, canvas);
    s.DrawReadout(run, time, canvas);
  }
  for (const StripChart& chart : s.charts) chart.DrawUpTo(time, canvas);
}

}  // namespace mjdiag
