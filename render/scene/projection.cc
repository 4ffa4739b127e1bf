#include "mjdiag/render/scene/projection.h"

#include <Eigen/Geometry>

namespace mjdiag {

mjvGLCamera EyeOf(const mjvScene& scene) {
  return mjv_averageCamera(&scene.camera[0], &scene.camera[1]);
}

double DistanceAhead(const mjvGLCamera& eye, const mjvGeom& geom) {
  double distance = 0.0;
  for (int i = 0; i < 3; ++i) distance += eye.forward[i] * (geom.pos[i] - eye.pos[i]);
  return distance;
}

Projection::Projection(const mjvGLCamera& eye, int width, int height)
    : eye_(eye), width_(width), height_(height) {}

std::optional<Eigen::Vector2d> Projection::operator()(
    const Eigen::Vector3d& point) const {
  const auto vector = [](const float* v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  const Eigen::Vector3d forward = vector(eye_.forward);
  const Eigen::Vector3d up = vector(eye_.up);
  const Eigen::Vector3d offset = point - vector(eye_.pos);
  const double distance = forward.dot(offset);
  if (distance < eye_.frustum_near) return std::nullopt;
  const double scale = eye_.frustum_near / distance;
  const double x = forward.cross(up).dot(offset) * scale - eye_.frustum_center;
  const double y = up.dot(offset) * scale;
  const double height = eye_.frustum_top - eye_.frustum_bottom;
  const double per_unit = height_ / height;
  return Eigen::Vector2d(0.5 * width_ + x * per_unit,
                         (eye_.frustum_top - y) * per_unit);
}

}  // namespace mjdiag
