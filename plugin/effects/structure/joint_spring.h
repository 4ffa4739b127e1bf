#pragma once
// The spring of a joint that has one, as the plant has it.

#include "mjdiag/plugin/effects/candidate_regressor.h"

namespace mjdiag {

struct JointSpring {
  explicit JointSpring(const SiteMotion& at) {
    const int joint = at.plant.dof_jntid[at.site.joint];
    const int address = at.plant.jnt_qposadr[joint];
    const double rest = at.plant.qpos_spring[address] - at.plant.qpos0[address];
    stiffness = at.plant.jnt_stiffness[joint];
    strain = at.q().array() - rest;
  }

  double stiffness;
  Eigen::VectorXd strain;  ///< along the motion
};

}  // namespace mjdiag
