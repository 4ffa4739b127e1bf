#include "mjdiag/plugin/effects/friction/dry_friction.h"

#include <algorithm>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

void AddDryFriction(mjModel& model, int joint, double force) {
  const int dof = model.jnt_dofadr[joint];
  model.dof_frictionloss[dof] += force;
  if (!HasOwnFrictionSolver(model, dof)) StiffenFriction(model, dof);
}

void TakeDryFriction(mjModel& model, int joint, double force) {
  mjtNum& friction = model.dof_frictionloss[model.jnt_dofadr[joint]];
  // What adding it would add, digit for digit.
  const mjtNum added = (friction + force) - friction;
  friction = std::max(0.0, friction - added);
}

bool HasOwnFrictionSolver(const mjModel& model, int dof) {
  mjtNum solref[mjNREF], solimp[mjNIMP];
  mj_defaultSolRefImp(solref, solimp);
  return !std::equal(solref, solref + mjNREF, RowOf(model.dof_solref, mjNREF, dof)) ||
         !std::equal(solimp, solimp + mjNIMP, RowOf(model.dof_solimp, mjNIMP, dof));
}

void StiffenFriction(mjModel& model, int dof) {
  mjtNum* solref = RowOf(model.dof_solref, mjNREF, dof);
  solref[0] = 2.0 * model.opt.timestep;
  solref[1] = 1.0;
  mjtNum* solimp = RowOf(model.dof_solimp, mjNIMP, dof);
  solimp[0] = 0.99;
  solimp[1] = 0.999;
  solimp[2] = 1e-4;
}

void VaryingBound::Bind(const mjModel& model, mjData& data) noexcept {
  const double added = Added(model, data);
  for (int i = 0; i < data.nefc; ++i) {
    if (data.efc_type[i] != mjCNSTR_FRICTION_DOF || data.efc_id[i] != dof_) continue;
    mjtNum& bound = data.efc_frictionloss[i];
    bound = std::max(bound + added, kLeastBound);
  }
}

}  // namespace mjdiag
