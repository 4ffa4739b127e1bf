#include "mjdiag/render/scene/ghost.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/render/scene/projection.h"

namespace mjdiag {
namespace {

// Of a geom between two poses: how far its centre moved and, at the radius of its
// bounding sphere, how far it turned.
double GeomDistance(const mjModel& model, const mjData& a, const mjData& b, int geom) {
  double moved = 0.0;
  double turned = 0.0;
  for (int i = 0; i < 3; ++i) {
    moved += std::pow(a.geom_xpos[3 * geom + i] - b.geom_xpos[3 * geom + i], 2);
  }
  for (int i = 0; i < 9; ++i) {
    turned += std::pow(a.geom_xmat[9 * geom + i] - b.geom_xmat[9 * geom + i], 2);
  }
  // |R_a - R_b|_F = sqrt(2) times the angle, for a small one.
  return std::sqrt(moved) + std::sqrt(turned / 2.0) * model.geom_rbound[geom];
}

bool IsShown(const mjModel& model, const Ghost& ghost, const mjvGeom& geom) {
  if (geom.objtype != mjOBJ_GEOM || geom.objid < 0) return false;
  return ghost.bodies[static_cast<std::size_t>(model.geom_bodyid[geom.objid])];
}

void MakeTranslucent(const Ghost& ghost, mjvGeom& geom) {
  geom.texid = -1;
  std::copy(ghost.rgb.begin(), ghost.rgb.end(), geom.rgba);
  geom.rgba[3] = ghost.opacity;
  geom.emission = 0.1F;  // its colour must read in the shade, too
  geom.specular = 0.0F;
  geom.reflectance = 0.0F;
  geom.transparent = 1;
}

// A hair away from the eye, along the line of sight: faces that both machines share are
// the machine's then, instead of flickering between the two.
void MoveBack(const mjvGLCamera& eye, mjvGeom& geom) {
  constexpr float kHair = 2e-3F;  // of the distance
  for (int i = 0; i < 3; ++i) geom.pos[i] += kHair * (geom.pos[i] - eye.pos[i]);
}

}  // namespace

BodyDistances::BodyDistances(const mjModel& model)
    : model_(&model), distances_(static_cast<std::size_t>(model.nbody), 0.0) {}

void BodyDistances::Compare(mjData& a, mjData& b) {
  mj_kinematics(model_, &a);
  mj_kinematics(model_, &b);
  for (int geom = 0; geom < model_->ngeom; ++geom) {
    double& distance = distances_[static_cast<std::size_t>(model_->geom_bodyid[geom])];
    distance = std::max(distance, GeomDistance(*model_, a, b, geom));
  }
}

std::vector<bool> BodyDistances::AtLeast(double distance) const {
  std::vector<bool> bodies;
  for (const double d : distances_) bodies.push_back(d >= distance);
  return bodies;
}

void AddGhost(const mjModel& model, mjData& data, const mjvOption& visual,
              const Ghost& ghost, mjvScene& scene) {
  const int machine = scene.ngeom;
  mjv_addGeoms(&model, &data, &visual, nullptr, mjCAT_DYNAMIC, &scene);
  const auto shown =
      std::remove_if(scene.geoms + machine, scene.geoms + scene.ngeom,
                     [&](const mjvGeom& geom) { return !IsShown(model, ghost, geom); });
  scene.ngeom = static_cast<int>(shown - scene.geoms);
  const mjvGLCamera eye = EyeOf(scene);
  std::for_each(scene.geoms + machine, shown, [&](mjvGeom& geom) {
    MakeTranslucent(ghost, geom);
    MoveBack(eye, geom);
  });
}

}  // namespace mjdiag
