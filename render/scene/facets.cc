#include "mjdiag/render/scene/facets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/render/scene/projection.h"

namespace mjdiag {
namespace {

constexpr double kChord = 0.5;  // [px]
// Fewer would show in the shading.
constexpr Facets kFewest{8, 4};

bool IsRound(const mjvGeom& geom) {
  return geom.type == mjGEOM_SPHERE || geom.type == mjGEOM_CAPSULE ||
         geom.type == mjGEOM_ELLIPSOID || geom.type == mjGEOM_CYLINDER;
}

// Of its widest circle [px]; 0 behind the camera.
double Radius(const mjvGeom& geom, const mjvGLCamera& eye, int height) {
  const double distance = DistanceAhead(eye, geom);
  if (distance < eye.frustum_near) return 0.0;
  double radius = std::max(geom.size[0], geom.size[1]);
  if (geom.type == mjGEOM_ELLIPSOID) radius = std::max<double>(radius, geom.size[2]);
  const double view = (eye.frustum_top - eye.frustum_bottom) / eye.frustum_near;
  return radius / (view * distance) * height;
}

int PiecesOfHalfCircle(double radius) {
  if (radius <= kChord) return 1;
  const double half_angle = std::acos(1.0 - kChord / radius);
  return static_cast<int>(std::ceil(std::numbers::pi / 2.0 / half_angle));
}

}  // namespace

Facets FacetsThatShow(const mjvScene& scene, int height, const Facets& most) {
  const mjvGLCamera eye = EyeOf(scene);
  Facets facets = kFewest;
  for (int i = 0; i < scene.ngeom; ++i) {
    const mjvGeom& geom = scene.geoms[i];
    if (!IsRound(geom)) continue;
    const int pieces = PiecesOfHalfCircle(Radius(geom, eye, height));
    facets.slices = std::max(facets.slices, 2 * pieces);
    // A cylinder's are straight.
    if (geom.type != mjGEOM_CYLINDER) facets.stacks = std::max(facets.stacks, pieces);
  }
  return {std::min(facets.slices, most.slices), std::min(facets.stacks, most.stacks)};
}

}  // namespace mjdiag
