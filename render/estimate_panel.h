#pragma once
// A panel with what a diagnosis says at a moment: a badge, and a line a fault with its
// estimate and 95 % interval on a common axis, the deviation from healthy in per cent
// of the fault parameter's unit (100 (value - healthy)).

#include <opencv2/core.hpp>
#include <vector>

#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/diagnosis_overlay.h"
#include "mjdiag/render/trace.h"
#include "mjdiag/render/typesetter.h"

namespace mjdiag {

class EstimatePanel {
 public:
  /// The overlay must outlive the panel.
  EstimatePanel(const ClipLayout& layout, const DiagnosisOverlay& overlay,
                Typesetter& type);

  /// Heading, names and axis: what stays the same in all frames.
  void DrawBackground(Typesetter& type, cv::Mat& picture) const;
  /// The badge and the estimates as they stand at `time` [s].
  void DrawAt(double time, Typesetter& type, cv::Mat& picture) const;

 private:
  void DrawBadge(double time, Typesetter& type, cv::Mat& picture) const;
  void DrawEstimate(const EstimateHistory& history, Eigen::Index at,
                    const cv::Rect& row, Typesetter& type, cv::Mat& picture) const;
  cv::Rect Row(std::size_t index) const;
  double Place(double deviation) const;

  DiagnosisLayout place_;
  Font title_, body_, small_;
  int margin_ = 0;
  const DiagnosisOverlay* overlay_;
  std::vector<std::size_t> shown_;  // indices of the estimates that have a row
  ValueRange axis_;                 // deviations from healthy
  cv::Rect plot_;                   // between names and numbers, over all rows
};

}  // namespace mjdiag
