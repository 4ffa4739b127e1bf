#pragma once
// Pictures of a MuJoCo model in any pose, from any of its cameras, at any size.

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "mjdiag/render/scene/ghost.h"
#include "mjdiag/render/scene/image.h"
#include "mjdiag/render/scene/projection.h"

namespace mjdiag {

/// How edges are smoothed. Either way costs about three times the time of none.
enum class Smoothing { kNone, kMultisample4, kSupersample2 };

struct SceneOptions {
  int width = 1280;  ///< [px], 16 .. 4096
  int height = 720;  ///< [px], 16 .. 4096
  std::string camera =
      {};  ///< MJCF camera; empty: a free camera that sees the whole model
  Smoothing smoothing = Smoothing::kNone;
  bool shadows = false;
};

/// Owns the OpenGL context and everything in it. A renderer belongs to the thread that
/// made it; several may live side by side. Same model, pose and options: same bytes.
class SceneRenderer {
 public:
  /// InputError on an unknown camera (lists the cameras), a size out of bounds, or no
  /// OpenGL. `model` must outlive the renderer and is not changed.
  SceneRenderer(const mjModel& model, const SceneOptions& options);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Draws the pose data.qpos; refreshes the kinematics in `data` but runs no callback.
  /// `image` is resized as needed, so that its memory can be reused.
  void Render(mjData& data, Image& image);
  /// The same with the ghost of a second pose; with the same ghost the same bytes.
  void Render(mjData& data, mjData& ghost_data, const Ghost& ghost, Image& image);

  /// Where the last picture shows what.
  Projection projection() const;

  /// Height of the picture [m] at the distance of what its middle shows in that pose
  /// (median of what is not background).
  double ViewHeight(mjData& data);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mjdiag
