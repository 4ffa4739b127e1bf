#include "mjdiag/studies/excitation/inertial_regressor.h"

#include <Eigen/Geometry>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Eigen::Index kOfBody = 10;
constexpr Eigen::Index kOfJoint = 3;

/// S(v) x = v x x.
Matrix3d Skew(const Vector3d& v) {
  return (Matrix3d() << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0)
      .finished();
}

/// L(v) with I v = L(v) [Ixx Iyy Izz Ixy Ixz Iyz]^T.
Eigen::Matrix<double, 3, 6> Turned(const Vector3d& v) {
  return (Eigen::Matrix<double, 3, 6>() << v.x(), 0.0, 0.0, v.y(), v.z(), 0.0,  //
          0.0, v.y(), 0.0, v.x(), 0.0, v.z(),                                   //
          0.0, 0.0, v.z(), 0.0, v.x(), v.y())
      .finished();
}

Vector3d In(const mjtNum* array, int body) {
  return Vector3d::Map(RowOf(array, 3, body));
}

}  // namespace

InertialRegressor::InertialRegressor(const mjModel& model)
    : model_(CopyModel(model)), data_(MakeData(model)) {
  const auto name = [&](const char* what, mjtObj kind, int id) {
    names_.push_back(std::string(what) + "@" + ElementName(model, kind, id));
  };
  for (int body = 1; body < model.nbody; ++body) {
    if (model.body_weldid[body] == 0) continue;
    bodies_.push_back(body);
    for (const char* what :
         {"mass", "moment_x", "moment_y", "moment_z", "inertia_xx", "inertia_yy",
          "inertia_zz", "inertia_xy", "inertia_xz", "inertia_yz"}) {
      name(what, mjOBJ_BODY, body);
    }
    for (const auto& [count, unit] : {std::pair{1, "kg"}, {3, "kg m"}, {6, "kg m^2"}})
      units_.insert(units_.end(), count, unit);
  }
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (model.jnt_type[joint] != mjJNT_HINGE && model.jnt_type[joint] != mjJNT_SLIDE) {
      throw InputError(ElementName(model, mjOBJ_JOINT, joint),
                       "a joint that is neither a hinge nor a slide",
                       "a machine whose joints all are");
    }
    for (const char* what : {"armature", "damping", "friction"})
      name(what, mjOBJ_JOINT, joint);
    if (model.jnt_type[joint] == mjJNT_HINGE) {
      units_.insert(units_.end(), {"kg m^2", "N m s/rad", "N m"});
    } else {
      units_.insert(units_.end(), {"kg", "N s/m", "N"});
    }
  }
}

VectorXd InertialRegressor::Values() const {
  VectorXd values(numbers());
  Eigen::Index at = 0;
  for (const int body : bodies_) {
    const double mass = model_->body_mass[body];
    const Vector3d centre = In(model_->body_ipos, body);
    const mjtNum* quat = RowOf(model_->body_iquat, 4, body);
    const Matrix3d axes =
        Eigen::Quaterniond(quat[0], quat[1], quat[2], quat[3]).toRotationMatrix();
    const Matrix3d inertia =
        axes * In(model_->body_inertia, body).asDiagonal() * axes.transpose() -
        mass * Skew(centre) * Skew(centre);
    values.segment<kOfBody>(at) << mass, mass * centre, inertia.diagonal(),
        inertia(0, 1), inertia(0, 2), inertia(1, 2);
    at += kOfBody;
  }
  for (int dof = 0; dof < model_->nv; ++dof, at += kOfJoint) {
    values.segment<kOfJoint>(at) << model_->dof_armature[dof], model_->dof_damping[dof],
        model_->dof_frictionloss[dof];
  }
  return values;
}

MatrixXd InertialRegressor::At(const VectorXd& position, const VectorXd& velocity,
                               const VectorXd& acceleration) {
  const mjModel* m = model_.get();
  mjData* d = data_.get();
  const Eigen::Index nv = joints();
  VectorXd::Map(d->qpos, nv) = position;
  VectorXd::Map(d->qvel, nv) = velocity;
  VectorXd::Map(d->qacc, nv) = acceleration;
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_comVel(m, d);
  d->ncon = 0;  // what touches is another question, and has no forces here
  mj_rnePostConstraint(m, d);

  MatrixXd Y = MatrixXd::Zero(nv, numbers());
  using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
  Jacobian moves(3, nv), turns(3, nv);
  Eigen::Index at = 0;
  for (const int body : bodies_) {
    Eigen::Matrix<double, 6, 1> rate, change;  // of turning, then of moving
    mj_objectVelocity(m, d, mjOBJ_XBODY, body, rate.data(), 1);
    mj_objectAcceleration(m, d, mjOBJ_XBODY, body, change.data(), 1);
    const Vector3d w = rate.head<3>(), dw = change.head<3>(), a = change.tail<3>();
    Eigen::Matrix<double, 3, kOfBody> force, torque;
    force << a, Skew(dw) + Skew(w) * Skew(w), Eigen::Matrix<double, 3, 6>::Zero();
    torque << Vector3d::Zero(), -Skew(a), Turned(dw) + Skew(w) * Turned(w);
    mj_jac(m, d, moves.data(), turns.data(), RowOf(d->xpos, 3, body), body);
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R =
        Eigen::Matrix<double, 3, 3, Eigen::RowMajor>::Map(RowOf(d->xmat, 9, body));
    Y.middleCols<kOfBody>(at).noalias() =
        moves.transpose() * (R * force) + turns.transpose() * (R * torque);
    at += kOfBody;
  }
  for (Eigen::Index dof = 0; dof < nv; ++dof, at += kOfJoint) {
    const double v = velocity[dof];
    Y.block<1, kOfJoint>(dof, at) << acceleration[dof], v,
        static_cast<double>((v > 0.0) - (v < 0.0));
  }
  return Y;
}

bool InertialRegressor::Touches() {
  mj_collision(model_.get(), data_.get());
  return data_->ncon > 0;
}

}  // namespace mjdiag
