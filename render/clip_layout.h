#pragma once
// Where everything lies on a clip's picture: a header line, the runs side by side with
// their titles and readouts, and below them one strip chart a trace. With a diagnosis,
// its panel stands right of the runs and its residual is the first and widest chart.

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "mjdiag/render/typesetter.h"

namespace mjdiag {

struct PanelLayout {
  cv::Rect view;     ///< the machine
  cv::Rect title;    ///< over the view
  cv::Rect ghost;    ///< over the view, the ghost's title; empty without
  cv::Rect legend;   ///< over the view, at its foot; empty without
  cv::Rect readout;  ///< over the view; one line a trace; empty without traces
};

struct ChartLayout {
  cv::Rect caption;
  cv::Rect plot;
  cv::Rect value_labels;  ///< left of the plot
  cv::Rect time_labels;   ///< below the plot
  cv::Rect level_labels;  ///< right of the plot; empty but for the residual
};

struct DiagnosisLayout {
  cv::Rect area;         ///< background of the panel
  cv::Rect badge;        ///< whether something was detected, and when
  cv::Rect heading;      ///< what the rows are
  cv::Rect rows;         ///< one line a fault
  cv::Rect axis_labels;  ///< numbers of the axis that the rows share
  cv::Rect axis_title;   ///< its quantity and unit
};

struct ClipLayout {
  Font title;
  Font body;
  Font small;
  int margin = 0;       ///< between things [px]
  int line_height = 0;  ///< of body text [px]
  cv::Size size;
  cv::Rect time;           ///< in the header
  cv::Rect speed;          ///< in the header
  cv::Rect amplification;  ///< in the header
  cv::Rect charts_area;    ///< background of all charts
  std::vector<PanelLayout> panels;
  std::vector<ChartLayout> charts;
  std::optional<DiagnosisLayout> diagnosis;
  std::optional<ChartLayout> residual;
};

/// What a picture shows beside its runs and traces.
struct LayoutExtras {
  bool diagnosis = false;
  bool ghost = false;  ///< a second title in every panel
  int legend = 0;      ///< lines at the foot of every panel
};

/// How many charts fit beside each other, and beside the residual if there is one.
std::size_t MostTraces(int width, bool diagnosis = false);

/// InputError if the size is odd or too small, or so many panels or traces do not fit.
ClipLayout LayOutClip(cv::Size size, std::size_t panels, std::size_t traces,
                      const LayoutExtras& extras = {});

/// Baseline's left end for text of that font, centred vertically in the box.
cv::Point BaselineIn(const cv::Rect& box, const Font& font);

}  // namespace mjdiag
