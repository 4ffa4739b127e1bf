#include "mjdiag/render/scene/drawing_order.h"

#include <algorithm>
#include <limits>

#include "mjdiag/render/scene/projection.h"

namespace mjdiag {
namespace {

// Planes are drawn last: their middle says nothing.
double Distance(const mjvGLCamera& eye, const mjvGeom& geom) {
  return geom.type == mjGEOM_PLANE ? std::numeric_limits<double>::infinity()
                                   : DistanceAhead(eye, geom);
}

bool IsOfModel(const mjvGeom& geom) {
  return geom.objtype == mjOBJ_GEOM && geom.objid >= 0;
}

}  // namespace

DrawingOrder::DrawingOrder(const mjModel& model, const mjvScene& scene)
    : ranks_(static_cast<std::size_t>(model.ngeom), model.ngeom) {
  const mjvGLCamera eye = EyeOf(scene);
  std::vector<mjvGeom> geoms(scene.geoms, scene.geoms + scene.ngeom);
  std::ranges::stable_sort(geoms, {},
                           [&eye](const mjvGeom& geom) { return Distance(eye, geom); });
  int rank = 0;
  for (const mjvGeom& geom : geoms) {
    if (IsOfModel(geom)) ranks_[static_cast<std::size_t>(geom.objid)] = rank++;
  }
}

void DrawingOrder::Sort(mjvScene& scene) const {
  if (ranks_.empty()) return;
  std::stable_sort(
      scene.geoms, scene.geoms + scene.ngeom, [this](const auto& a, const auto& b) {
        const auto rank = [this](const mjvGeom& geom) {
          return IsOfModel(geom) ? ranks_[static_cast<std::size_t>(geom.objid)]
                                 : static_cast<int>(ranks_.size());
        };
        return rank(a) < rank(b);
      });
}

}  // namespace mjdiag
