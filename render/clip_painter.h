#pragma once
// Paints one picture of a clip after another, in two steps that may go on at once:
// OpenGL renders the machine of the next picture while the last one gets its text and
// charts.

#include <memory>
#include <span>
#include <vector>

#include "mjdiag/render/clip.h"
#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/machine_views.h"
#include "mjdiag/render/record_sampling.h"

namespace mjdiag {

/// What OpenGL has drawn of one picture.
struct ClipView {
  double time = 0.0;                 ///< [s]
  std::vector<RenderedView> panels;  ///< of ClipLayout
};

class ClipPainter {
 public:
  /// Checks all that can be wrong with runs and options (see RenderClip). The records
  /// must outlive the painter.
  /// @param speed      seconds of machine time a second of clip; 0: a still
  /// @param time_step  machine time between pictures [s]; decides the clock's decimals
  ClipPainter(const mjModel& model, std::span<const ClipRun> runs,
              const PictureOptions& options, double speed, double time_step);
  ~ClipPainter();

  /// The part of the runs that is shown.
  TimeRange range() const;
  const ClipLayout& layout() const;
  JointFactors amplification() const;
  /// Renders the machine at `time` [s], in the thread that made the painter. `view`
  /// keeps its memory.
  void Render(double time, ClipView& view);
  /// Paints the picture of a rendered moment, in any one thread beside Render's;
  /// `picture` is resized as needed.
  void Paint(const ClipView& view, Image& picture);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mjdiag
