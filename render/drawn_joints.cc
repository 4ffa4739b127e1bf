#include "mjdiag/render/drawn_joints.h"

#include <limits>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

bool IsScalar(const mjModel& model, int joint) {
  return model.jnt_type[joint] == mjJNT_SLIDE || model.jnt_type[joint] == mjJNT_HINGE;
}

// Moment arms at qpos0, nu x nv in rows.
std::vector<double> MomentArms(const mjModel& model) {
  const DataPtr data = MakeData(model);
  mj_kinematics(&model, data.get());
  mj_comPos(&model, data.get());
  mj_tendon(&model, data.get());
  mj_transmission(&model, data.get());
  return {data->actuator_moment, RowOf(data->actuator_moment, model.nv, model.nu)};
}

// The joint that takes most of the actuator's static stroke; -1: none.
int DrivenJoint(const mjModel& model, const double* moment_arms) {
  int driven = -1;
  double largest = 0.0;
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (!IsScalar(model, joint)) continue;
    const double arm = moment_arms[model.jnt_dofadr[joint]];
    if (arm == 0.0) continue;
    const double stiffness = model.jnt_stiffness[joint];
    const double stroke = stiffness > 0.0 ? arm * arm / stiffness
                                          : std::numeric_limits<double>::infinity();
    if (stroke > largest) {
      largest = stroke;
      driven = joint;
    }
  }
  return driven;
}

}  // namespace

std::vector<DrawnJoint> DrawnJoints(const mjModel& model) {
  const std::vector<double> arms = MomentArms(model);
  std::vector<bool> driven(model.njnt, false);
  for (int actuator = 0; actuator < model.nu; ++actuator) {
    const int joint = DrivenJoint(model, RowOf(arms.data(), model.nv, actuator));
    if (joint >= 0) driven[joint] = true;
  }

  std::vector<DrawnJoint> joints;
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (!IsScalar(model, joint)) continue;
    const bool is_driven = driven[joint] || model.jnt_stiffness[joint] == 0.0;
    joints.push_back({ElementName(model, mjOBJ_JOINT, joint),
                      model.jnt_type[joint] == mjJNT_SLIDE ? JointMotion::kTranslation
                                                           : JointMotion::kRotation,
                      is_driven ? JointRole::kDriven : JointRole::kCompliant});
  }
  return joints;
}

void SetPositions(const mjModel& model, const Eigen::VectorXd& positions,
                  mjData& data) {
  Eigen::Index next = 0;
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (IsScalar(model, joint)) data.qpos[model.jnt_qposadr[joint]] = positions[next++];
  }
}

}  // namespace mjdiag
