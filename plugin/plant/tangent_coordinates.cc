#include "mjdiag/plugin/plant/tangent_coordinates.h"

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::VectorXd;

std::vector<std::string> CoordinateNames(const mjModel& model) {
  std::vector<std::string> names;
  for (int joint = 0; joint < model.njnt; ++joint) {
    const std::string name = ElementName(model, mjOBJ_JOINT, joint);
    const int type = model.jnt_type[joint];
    if (type == mjJNT_SLIDE || type == mjJNT_HINGE) {
      names.push_back(name);
      continue;
    }
    if (type == mjJNT_FREE) {
      for (const char* axis : {".x", ".y", ".z"}) names.push_back(name + axis);
    }
    for (const char* axis : {".rx", ".ry", ".rz"}) names.push_back(name + axis);
  }
  return names;
}

bool IsLength(const mjModel& model, int dof) {
  const int joint = model.dof_jntid[dof];
  const int type = model.jnt_type[joint];
  return type == mjJNT_SLIDE ||
         (type == mjJNT_FREE && dof < model.jnt_dofadr[joint] + 3);
}

VectorXd Displaced(const mjModel& model, const VectorXd& qpos,
                   const VectorXd& displacement) {
  VectorXd moved = qpos;
  mj_integratePos(&model, moved.data(), displacement.data(), 1.0);
  return moved;
}

VectorXd Displacement(const mjModel& model, const VectorXd& from, const VectorXd& to) {
  VectorXd displacement(model.nv);
  mj_differentiatePos(&model, displacement.data(), 1.0, from.data(), to.data());
  return displacement;
}

}  // namespace mjdiag
