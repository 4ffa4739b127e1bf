#pragma once
// One strip chart: a quantity of every run over time, drawn up to the present moment in
// full colour and beyond it faintly.

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/engineering.h"
#include "mjdiag/render/trace.h"
#include "mjdiag/render/typesetter.h"

namespace mjdiag {

/// What a chart shows beside its traces.
struct StripMarks {
  struct Level {
    double value = 0.0;
    std::string name;
  };
  std::vector<Level> levels;     ///< dashed, with their names right of the plot
  std::optional<double> moment;  ///< [s]; a line in the plot from then on
  std::string moment_name;       ///< in the caption's line from then on
  std::size_t first_colour = 0;  ///< palette index of the first run
};

class StripChart {
 public:
  StripChart(const ClipLayout& layout, const ChartLayout& place, const Trace& trace,
             std::span<const Record* const> runs, TimeRange range,
             StripMarks marks = {});

  /// Caption, axes, grid and the faint traces: what stays the same in all frames.
  void DrawBackground(Typesetter& type, cv::Mat& picture);
  /// Call after DrawBackground: the traces up to `time`, a cursor there, and the marked
  /// moment if it is past.
  void DrawUpTo(double time, Typesetter& type, cv::Mat& picture) const;

 private:
  // A run's trace in plot coordinates, fractions of a pixel.
  struct Curve {
    std::vector<double> times;  // of the points [s]
    std::vector<cv::Point2d> points;
  };

  Curve MakeCurve(const Record& record, const Eigen::VectorXd& samples) const;
  cv::Point2d Place(double time, double value) const;
  void DrawValueAxis(Typesetter& type, cv::Mat& picture) const;
  void DrawTimeAxis(Typesetter& type, cv::Mat& picture) const;
  std::string Caption(Typesetter& type) const;
  void DrawCurves(double share, cv::Mat& picture) const;
  void DrawLevels(Typesetter& type, cv::Mat& picture) const;
  void DrawMoment(Typesetter& type, cv::Mat& picture) const;

  ChartLayout place_;
  Font font_;
  double line_width_ = 1.0;  // [px]
  std::string caption_;
  std::string short_caption_;  // where the long one does not fit
  std::string unit_;           // "[...]", behind either
  TimeRange range_;
  ValueRange values_;
  std::vector<double> value_ticks_;
  EngineeringFormat value_format_;
  std::vector<Curve> curves_;
  StripMarks marks_;
  cv::Mat past_;  // the plot as it looks when all is past
};

}  // namespace mjdiag
