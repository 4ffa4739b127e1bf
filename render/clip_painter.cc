#include "mjdiag/render/clip_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mjdiag/render/amplification_label.h"
#include "mjdiag/render/engineering.h"
#include "mjdiag/render/estimate_panel.h"
#include "mjdiag/render/palette.h"
#include "mjdiag/render/site_path.h"
#include "mjdiag/render/strip_chart.h"
#include "mjdiag/render/strokes.h"
#include "mjdiag/render/trace.h"
#include "mjdiag/render/view_painter.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

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
    const std::size_t most = MostTraces(options.width, options.diagnosis.has_value());
    axes.resize(std::min(axes.size(), most));
  }
  return TrackingErrors(records, axes);
}

std::string SpeedText(double speed) {
  if (speed == 0.0) return "";
  if (speed == 1.0) return "real time";
  if (speed > 1.0) return GroupedNumber(speed) + "\u00d7 faster";
  return GroupedNumber(1.0 / speed) + "\u00d7 slower";
}

LayoutExtras Extras(const mjModel& model, const PictureOptions& options,
                    std::size_t runs) {
  LayoutExtras extras{options.diagnosis.has_value(), options.ghost, 0};
  if (PathSite(model, options.path_site)) {
    extras.legend = options.ghost ? static_cast<int>(runs) : 1;
  }
  return extras;
}

}  // namespace

struct ClipPainter::State {
  State(const mjModel& source, std::span<const ClipRun> clip_runs,
        const PictureOptions& options, double clip_speed, double time_step)
      : runs(clip_runs.begin(), clip_runs.end()),
        records(Records(clip_runs)),
        range(ShownRange(records, options)),
        traces(ShownTraces(records, options)),
        diagnosis(options.diagnosis),
        layout(LayOutClip({options.width, options.height},
                          options.ghost ? 1 : runs.size(), traces.size(),
                          Extras(source, options, runs.size()))),
        views(source, records, range, options, layout),
        view_painter(runs, layout, views),
        speed(SpeedText(clip_speed)),
        clock(FormatForResolution(
            "s", std::max(std::abs(range.begin), std::abs(range.end)), time_step)) {
    for (const Trace& trace : traces) readout_formats.push_back(ReadoutFormat(trace));
    for (std::size_t i = 0; i < traces.size(); ++i) {
      charts.emplace_back(layout, layout.charts[i], traces[i], records, range);
    }
    if (diagnosis) AddDiagnosis();
    DrawBackground();
  }

  void AddDiagnosis() {
    CheckOverlay(*diagnosis, runs.size());
    const Channel& residual = diagnosis->residual.channels()[0];
    const Trace trace{"residual", "residual", residual.unit, {residual.samples}};
    const std::array<const Record*, 1> record{&diagnosis->residual};
    const StripMarks marks{
        {{diagnosis->limit_high, "upper limit"}, {diagnosis->limit_low, "lower limit"}},
        diagnosis->detection,
        "detected at " + DetectionText(*diagnosis),
        diagnosis->run};
    charts.emplace_back(layout, *layout.residual, trace, record, range, marks);
    estimates.emplace(layout, *diagnosis, type);
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
    for (StripChart& chart : charts) chart.DrawBackground(type, background);
    if (estimates) estimates->DrawBackground(type, background);
  }

  void DrawAmplification() {
    const cv::Rect& box = layout.amplification;
    std::string text;
    for (const std::string& label : AmplificationLabels(views.amplification())) {
      text = type.Fit(label, box.width, layout.small);
      if (text == label) break;
    }
    cv::Point origin = BaselineIn(box, layout.small);
    origin.x = box.br().x - type.Width(text, layout.small);
    type.Draw(text, origin, layout.small, palette::kInk, background);
  }

  void DrawReadout(std::size_t panel, double time, cv::Mat& picture) {
    const cv::Rect& box = layout.panels[panel].readout;
    const std::size_t run = views.RunOf(panel);
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

  std::vector<ClipRun> runs;
  std::vector<const Record*> records;
  TimeRange range;
  std::vector<Trace> traces;
  std::optional<DiagnosisOverlay> diagnosis;
  ClipLayout layout;
  MachineViews views;
  ViewPainter view_painter;
  std::string speed;
  EngineeringFormat clock;
  std::vector<EngineeringFormat> readout_formats;
  std::vector<StripChart> charts;
  std::optional<EstimatePanel> estimates;
  Typesetter type;
  cv::Mat background;
};

ClipPainter::ClipPainter(const mjModel& model, std::span<const ClipRun> runs,
                         const PictureOptions& options, double speed, double time_step)
    : state_(std::make_unique<State>(model, runs, options, speed, time_step)) {}

ClipPainter::~ClipPainter() = default;

TimeRange ClipPainter::range() const { return state_->range; }
const ClipLayout& ClipPainter::layout() const { return state_->layout; }

JointFactors ClipPainter::amplification() const {
  const Amplification& amplification = state_->views.amplification();
  JointFactors factors;
  for (std::size_t i = 0; i < amplification.joints().size(); ++i) {
    factors[amplification.joints()[i].name] = amplification.factors()[i];
  }
  return factors;
}

void ClipPainter::Render(double time, ClipView& view) {
  view.time = time;
  view.panels.resize(state_->layout.panels.size());
  for (std::size_t panel = 0; panel < view.panels.size(); ++panel) {
    state_->views.Render(panel, time, view.panels[panel]);
  }
}

void ClipPainter::Paint(const ClipView& view, Image& picture) {
  State& s = *state_;
  picture.width = s.layout.size.width;
  picture.height = s.layout.size.height;
  picture.rgb.resize(3 * static_cast<std::size_t>(picture.width) * picture.height);
  cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.rgb.data());
  s.background.copyTo(canvas);
  s.DrawClock(view.time, canvas);
  for (std::size_t panel = 0; panel < view.panels.size(); ++panel) {
    s.view_painter.Paint(panel, view.time, view.panels[panel], s.type, canvas);
    s.DrawReadout(panel, view.time, canvas);
  }
  for (const StripChart& chart : s.charts) chart.DrawUpTo(view.time, s.type, canvas);
  if (s.estimates) s.estimates->DrawAt(view.time, s.type, canvas);
}

}  // namespace mjdiag
