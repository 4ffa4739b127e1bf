#pragma once
// Where a picture of a scene shows a point of the world.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <optional>

namespace mjdiag {

/// The eye of a scene, which MuJoCo keeps as a pair.
mjvGLCamera EyeOf(const mjvScene& scene);

/// How far the middle of a geom lies along the line of sight [m]; negative behind.
double DistanceAhead(const mjvGLCamera& eye, const mjvGeom& geom);

/// The perspective projection of the fixed pipeline: with z = forward . (p - eye), near
/// plane n and the frustum's centre c and top t there,
///   x = w / 2 + k (right . (p - eye) n / z - c),  y = k (t - up . (p - eye) n / z)
/// where k [px/m] is the picture's height over the frustum's at the near plane.
class Projection {
 public:
  Projection() = default;
  /// @param width, height  of the picture [px]
  Projection(const mjvGLCamera& eye, int width, int height);

  /// Pixels from the picture's left top to what is shown of `point` [m]; nothing for
  /// points before the near plane.
  std::optional<Eigen::Vector2d> operator()(const Eigen::Vector3d& point) const;

 private:
  mjvGLCamera eye_{};
  int width_ = 0;
  int height_ = 0;
};

}  // namespace mjdiag
