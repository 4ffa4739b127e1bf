#include "mjdiag/render/clip.h"

#include <cmath>

#include "mjdiag/render/clip_layout.h"
#include "mjdiag/render/clip_painter.h"
#include "mjdiag/render/clip_writer.h"
#include "mjdiag/render/site_path.h"
#include "mjdiag/render/stage.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::size_t kMostWaiting = 4;  // pictures that are rendered, not yet painted

void CheckPositive(const char* name, double value) {
  if (std::isfinite(value) && value > 0.0) return;
  throw InputError(name, std::to_string(value), "a finite number > 0");
}

}  // namespace

void CheckPicture(const mjModel& model, const PictureOptions& options) {
  LayOutClip({options.width, options.height}, 1, 0);
  PathSite(model, options.path_site);
  // A small picture finds out as much as a large one.
  constexpr int kSide = 16;
  const SceneRenderer probe(model, {kSide, kSide, options.camera});
  if (options.begin && options.end && !(*options.begin < *options.end)) {
    throw InputError(
        "time range",
        std::to_string(*options.begin) + " to " + std::to_string(*options.end) + " s",
        "begin before end");
  }
}

ClipSummary RenderClip(const mjModel& model, std::span<const ClipRun> runs,
                       const ClipOptions& options, const std::filesystem::path& file) {
  CheckPositive("fps", options.fps);
  CheckPositive("speed", options.speed);
  const double step = options.speed / options.fps;
  ClipPainter painter(model, runs, options.picture, options.speed, step);
  ClipWriter writer(file, options.picture.width, options.picture.height, options.fps,
                    options.frames);

  const TimeRange range = painter.range();
  const int frames = 1 + static_cast<int>((range.end - range.begin) / step + 1e-6);
  Image picture;
  // OpenGL stays in this thread; painting and encoding go on beside it.
  Stage<ClipView> finishing(kMostWaiting, [&](ClipView& view) {
    painter.Paint(view, picture);
    writer.Write(picture);
  });
  ClipView view;
  for (int n = 0; n < frames; ++n) {
    painter.Render(range.begin + n * step, view);
    finishing.Push(view);
    if (options.progress) options.progress((n + 1.0) / frames);
  }
  finishing.Finish();
  writer.Finish();
  return {frames, writer.codec(), painter.amplification()};
}

JointFactors RenderStill(const mjModel& model, std::span<const ClipRun> runs,
                         const PictureOptions& options, double time,
                         const std::filesystem::path& file) {
  ClipPainter painter(model, runs, options, 0.0, 1e-4);
  const TimeRange range = painter.range();
  if (!(time >= range.begin && time <= range.end)) {
    throw InputError("time of the still", std::to_string(time) + " s",
                     std::to_string(range.begin) + " to " + std::to_string(range.end));
  }
  ClipView view;
  painter.Render(time, view);
  Image picture;
  painter.Paint(view, picture);
  WritePng(file, picture);
  return painter.amplification();
}

}  // namespace mjdiag
