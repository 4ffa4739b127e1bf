#pragma once
// Where everything lies on a clip's picture: a header line, the runs side by side with
// their titles and readouts, and below them one strip chart a trace.

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "mjdiag/render/typesetter.h"

namespace mjdiag {

struct PanelLayout {
  cv::Rect view;     ///< the machine
  cv::Rect title;    ///< over the view
  cv::Rect readout;  ///< over the view; one line a trace; empty without traces
};

struct ChartLayout {
  cv::Rect caption;
  cv::Rect plot;
  cv::Rect value_labels;  ///< left of the plot
  cv::Rect time_labels;   ///< below the plot
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
};

/// How many charts fit beside each other.
std::size_t MostTraces(int width);

/// InputError if the size is odd or too small, or so many panels or traces do not fit.
ClipLayout LayOutClip(cv::Size size, std::size_t panels, std::size_t traces);

/// Baseline's left end for text of that font, centred vertically in the box.
cv::Point BaselineIn(const cv::Rect& box, const Font& font);

}  // namespace mjdiag
