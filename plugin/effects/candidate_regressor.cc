#include "mjdiag/plugin/effects/candidate_regressor.h"

#include <utility>

#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd SiteMotion::motor() const {
  const MotorBias bias = MotorBiasAtQpos0(plant);
  return motion.inputs.transpose() * model.Gamma.row(site.joint).transpose() -
         motion.position.transpose() * bias.stiffness.row(site.joint).transpose() -
         motion.velocity.transpose() * bias.damping.row(site.joint).transpose();
}

VectorXd SiteMotion::before_gear() const {
  const int motor = FindElement(plant, mjOBJ_ACTUATOR, site.name);
  const DataPtr data = MakeData(plant);
  mj_fwdPosition(&plant, data.get());
  const double length = data->actuator_length[motor];
  const VectorXd arm =
      VectorXd::Map(RowOf(data->actuator_moment, plant.nv, motor), plant.nv);
  VectorXd force(motion.samples());
  for (Index k = 0; k < force.size(); ++k) {
    data->ctrl[motor] = motion.inputs(site.channel, k);
    data->actuator_length[motor] = length + arm.dot(motion.position.col(k));
    data->actuator_velocity[motor] = arm.dot(motion.velocity.col(k));
    force[k] = MotorForce(plant, *data, motor);
  }
  return force;
}

MatrixXd SiteMotion::JointEntry(Index columns) const {
  return VectorXd::Unit(model.M.rows(), site.joint).replicate(1, columns);
}

MatrixXd SiteMotion::MotorEntry(Index columns) const {
  return model.Gamma.col(site.channel).replicate(1, columns);
}

CandidateRegressor LinearRegressor(MatrixXd signals, MatrixXd entry, double offset,
                                   bool not_negative) {
  Amplitudes least;
  if (not_negative) least = Amplitudes::Constant(signals.cols(), -offset);
  return {
      std::move(signals), std::move(entry),
      [offset](const Amplitudes& a) -> RegressorValues { return offset + a.array(); },
      std::move(least)};
}

}  // namespace mjdiag
