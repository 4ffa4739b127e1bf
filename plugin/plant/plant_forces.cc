#include "mjdiag/plugin/plant/plant_forces.h"

#include "mjdiag/plugin/plant/tangent_coordinates.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

PlantForces::PlantForces(const mjModel& model, const VectorXd& qpos)
    : model_(model), data_(MakeData(model)) {
  MoveTo(qpos);
}

VectorXd PlantForces::qpos() const { return VectorXd::Map(data_->qpos, model_.nq); }

void PlantForces::MoveTo(const VectorXd& qpos) {
  VectorXd::Map(data_->qpos, model_.nq) = qpos;
}

void PlantForces::Update() {
  mj_fwdPosition(&model_, data_.get());
  mj_sensorPos(&model_, data_.get());
  mj_fwdVelocity(&model_, data_.get());
  mj_sensorVel(&model_, data_.get());
  mj_fwdActuation(&model_, data_.get());
}

VectorXd PlantForces::Smooth() {
  Update();
  const auto map = [&](const mjtNum* vector) { return VectorXd::Map(vector, size()); };
  return map(data_->qfrc_passive) - map(data_->qfrc_bias) + map(data_->qfrc_actuator);
}

VectorXd PlantForces::OfConstraints() {
  if (data_->nefc == 0) return VectorXd::Zero(size());
  const VectorXd without_acceleration = -VectorXd::Map(data_->efc_aref, data_->nefc);
  mj_constraintUpdate(&model_, data_.get(), without_acceleration.data(), nullptr, 0);
  return VectorXd::Map(data_->qfrc_constraint, size());
}

VectorXd PlantForces::Total() {
  const VectorXd smooth = Smooth();
  return smooth + OfConstraints();
}

MatrixXd PlantForces::Mass() {
  Update();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> mass(size(),
                                                                              size());
  mj_fullM(&model_, mass.data(), data_->qM);
  return mass;
}

namespace {

/// Column by column, by steps of one coordinate. @param value  at so many steps of it
MatrixXd SixthOrder(int arguments, double step,
                    const std::function<VectorXd(int argument, double by)>& value) {
  constexpr double kWeights[] = {45.0, -9.0, 1.0};
  MatrixXd jacobian;
  for (int j = 0; j < arguments; ++j) {
    VectorXd sum;
    for (int k = 1; k <= 3; ++k) {
      const VectorXd difference =
          kWeights[k - 1] * (value(j, k * step) - value(j, -k * step));
      sum = k == 1 ? difference : (sum + difference).eval();
    }
    if (j == 0) jacobian.resize(sum.size(), arguments);
    jacobian.col(j) = sum / (60.0 * step);
  }
  return jacobian;
}

constexpr double kWideStep = 1e-2;

}  // namespace

MatrixXd ByPosition(PlantForces& forces, const std::function<VectorXd()>& function) {
  const VectorXd here = forces.qpos();
  const MatrixXd jacobian = SixthOrder(forces.size(), kWideStep, [&](int j, double by) {
    forces.MoveTo(
        Displaced(forces.model(), here, by * VectorXd::Unit(forces.size(), j)));
    return function();
  });
  forces.MoveTo(here);
  return jacobian;
}

MatrixXd ByPosition(PlantForces& forces, const std::function<VectorXd()>& function,
                    double step) {
  const VectorXd here = forces.qpos();
  MatrixXd jacobian;
  for (int j = 0; j < forces.size(); ++j) {
    const VectorXd by = step * VectorXd::Unit(forces.size(), j);
    forces.MoveTo(Displaced(forces.model(), here, by));
    VectorXd difference = function();
    forces.MoveTo(Displaced(forces.model(), here, -by));
    difference -= function();
    if (j == 0) jacobian.resize(difference.size(), forces.size());
    jacobian.col(j) = difference / (2.0 * step);
  }
  forces.MoveTo(here);
  return jacobian;
}

MatrixXd ByVelocity(PlantForces& forces, const std::function<VectorXd()>& function) {
  // Terms quadratic in the velocity cancel in central differences; the drag of a fluid,
  // v |v|, does so in small steps only.
  const double step = forces.model().opt.density > 0.0 ? 1e-5 : kWideStep;
  mjtNum* velocity = forces.data().qvel;
  return SixthOrder(forces.size(), step, [&](int j, double by) {
    const double here = velocity[j];
    velocity[j] = here + by;
    VectorXd value = function();
    velocity[j] = here;
    return value;
  });
}

VectorXd ScalarSprings(const mjModel& model) {
  VectorXd stiffness = VectorXd::Zero(model.nv);
  for (int joint = 0; joint < model.njnt; ++joint) {
    const int type = model.jnt_type[joint];
    if (type != mjJNT_SLIDE && type != mjJNT_HINGE) continue;
    stiffness[model.jnt_dofadr[joint]] = model.jnt_stiffness[joint];
  }
  if ((model.opt.disableflags & mjDSBL_PASSIVE) != 0) stiffness.setZero();
  return stiffness;
}

ModelPtr WithoutJointSprings(const mjModel& model) {
  ModelPtr copy = CopyModel(model);
  for (int joint = 0; joint < model.njnt; ++joint) {
    const int type = model.jnt_type[joint];
    if (type == mjJNT_SLIDE || type == mjJNT_HINGE) copy->jnt_stiffness[joint] = 0.0;
  }
  mju_zero(copy->dof_damping, static_cast<int>(copy->nv));
  copy->opt.disableflags |= mjDSBL_CONSTRAINT;
  return copy;
}

}  // namespace mjdiag
