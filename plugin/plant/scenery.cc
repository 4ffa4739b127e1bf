#include "mjdiag/plugin/plant/scenery.h"

#include <algorithm>

namespace mjdiag {
namespace {

bool AnyCanTouch(const mjModel& model) {
  if ((model.opt.disableflags & mjDSBL_CONTACT) != 0) return false;
  const auto set = [](int bits) { return bits != 0; };
  return model.npair > 0 ||
         std::any_of(model.geom_contype, model.geom_contype + model.ngeom, set) ||
         std::any_of(model.geom_conaffinity, model.geom_conaffinity + model.ngeom, set);
}

bool AnyIsRead(const mjModel& model, mjtObj kind) {
  const auto same = [kind](int other) { return other == kind; };
  return std::any_of(model.sensor_objtype, model.sensor_objtype + model.nsensor,
                     same) ||
         std::any_of(model.sensor_reftype, model.sensor_reftype + model.nsensor, same);
}

bool AnyIsLookedFor(const mjModel& model) {
  return std::find(model.sensor_type, model.sensor_type + model.nsensor,
                   static_cast<int>(mjSENS_RANGEFINDER)) !=
         model.sensor_type + model.nsensor;
}

bool AnyHoldsATendon(const mjModel& model) {
  return std::any_of(model.wrap_type, model.wrap_type + model.nwrap, [](int kind) {
    return kind == mjWRAP_SPHERE || kind == mjWRAP_CYLINDER;
  });
}

bool AnyIsInAFluid(const mjModel& model) {
  return model.opt.density > 0.0 || model.opt.viscosity > 0.0;
}

/// Rows that the constraints of a model in which nothing touches can have at most: equality
/// constraints six each, friction of joints and tendons one a degree of freedom, limits two.
int MostRows(const mjModel& model) {
  return 6 * model.neq + model.nv + 2 * model.njnt + 3 * model.ntendon;
}

}  // namespace

void DropUnusedRows(mjModel& model) {
  if (!AnyCanTouch(model)) model.njmax = std::min(model.njmax, MostRows(model));
}

void DropScenery(mjModel& model) {
  model.nlight = 0;
  if (!AnyIsRead(model, mjOBJ_CAMERA)) model.ncam = 0;
  if (AnyCanTouch(model) || AnyIsRead(model, mjOBJ_GEOM) || AnyIsLookedFor(model) ||
      AnyHoldsATendon(model) || AnyIsInAFluid(model)) {
    return;
  }
  model.opt.disableflags |= mjDSBL_CONTACT;
  model.ngeom = 0;
}

}  // namespace mjdiag
