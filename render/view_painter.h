#pragma once
// Puts rendered views on a picture, with titles, and the path of a site over them.

#include <span>

#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/machine_views.h"
#include "mjdiag/render/typesetter.h"

namespace mjdiag {

class ViewPainter {
 public:
  /// All must outlive the painter.
  ViewPainter(std::span<const ClipRun> runs, const ClipLayout& layout,
              const MachineViews& views);

  /// View, titles and path of the panel as of `time` [s].
  void Paint(std::size_t panel, double time, const RenderedView& rendered,
             Typesetter& type, cv::Mat& picture) const;

 private:
  void DrawTitle(const cv::Rect& place, std::size_t run, bool is_ghost,
                 Typesetter& type, cv::Mat& picture) const;
  void DrawPath(const cv::Rect& view, std::size_t run, double time,
                const Projection& project, cv::Mat& picture) const;
  void DrawLegend(const PanelLayout& panel, std::span<const std::size_t> runs,
                  Typesetter& type, cv::Mat& picture) const;

  std::span<const ClipRun> runs_;
  const ClipLayout& layout_;
  const MachineViews& views_;
};

}  // namespace mjdiag
