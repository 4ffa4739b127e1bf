#pragma once
// Paints one picture of a clip after another.

#include <memory>
#include <span>

#include "mjdiag/render/clip.h"
#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/record_sampling.h"

namespace mjdiag {

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
  /// Paints the moment `time` [s]; `picture` is resized as needed.
  void Paint(double time, Image& picture);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mjdiag
