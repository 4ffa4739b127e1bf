#include "mjdiag/discovery/hypotheses/number_forces.h"

#include <cmath>
#include <vector>

#include "mjdiag/plugin/effects/trial_signals.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A plant that is put where a motion is.
class AlongMotion {
 public:
  AlongMotion(ModelPtr plant, const Channels& channels, const ObservedMotion& motion)
      : plant_(std::move(plant)), data_(MakeData(*plant_)), motion_(motion) {
    for (const ActuatorSetup& actuator : channels.actuators) {
      actuators_.push_back(FindElement(*plant_, mjOBJ_ACTUATOR, actuator.element));
    }
  }

  /// M q'' + c + g, without rotors.
  VectorXd Inertial(Index k) {
    Move(k);
    VectorXd force(plant_->nv);
    mj_comVel(plant_.get(), data_.get());
    mj_rne(plant_.get(), data_.get(), 1, force.data());
    return force;
  }
  VectorXd Motors(Index k) {
    Move(k);
    for (std::size_t u = 0; u < actuators_.size(); ++u) {
      data_->ctrl[actuators_[u]] = motion_.inputs(static_cast<Index>(u), k);
    }
    mj_tendon(plant_.get(), data_.get());
    mj_transmission(plant_.get(), data_.get());
    mj_fwdVelocity(plant_.get(), data_.get());
    mj_fwdActuation(plant_.get(), data_.get());
    return VectorXd::Map(data_->qfrc_actuator, plant_->nv);
  }

 private:
  void Move(Index k) {
    const int nv = plant_->nv;
    VectorXd::Map(data_->qpos, nv) =
        VectorXd::Map(plant_->qpos0, nv) + motion_.position.col(k);
    VectorXd::Map(data_->qvel, nv) = motion_.velocity.col(k);
    VectorXd::Map(data_->qacc, nv) = motion_.own_acceleration.col(k);
    mj_kinematics(plant_.get(), data_.get());
    mj_comPos(plant_.get(), data_.get());
  }

  ModelPtr plant_;
  DataPtr data_;
  const ObservedMotion& motion_;
  std::vector<int> actuators_;
};

ModelPtr Scaled(const mjModel& plant, const PlantNumber& number, double factor) {
  ModelPtr scaled = CopyModel(plant);
  Scale(*scaled, number, factor);
  return scaled;
}

MatrixXd MassForce(const mjModel& plant, const Channels& channels,
                   const PlantNumber& number, const ObservedMotion& motion) {
  AlongMotion once(CopyModel(plant), channels, motion);
  AlongMotion twice(Scaled(plant, number, 2.0), channels, motion);
  MatrixXd force(motion.samples(), plant.nv);
  for (Index k = 0; k < motion.samples(); ++k) {
    force.row(k) = (once.Inertial(k) - twice.Inertial(k)).transpose();
  }
  return force;
}

/// A centre of mass enters squared: by a difference about it.
MatrixXd CentreForce(const mjModel& plant, const Channels& channels,
                     const PlantNumber& number, const ObservedMotion& motion) {
  constexpr double kStep = 1e-4;
  AlongMotion less(Scaled(plant, number, std::exp(-kStep)), channels, motion);
  AlongMotion more(Scaled(plant, number, std::exp(kStep)), channels, motion);
  MatrixXd force(motion.samples(), plant.nv);
  for (Index k = 0; k < motion.samples(); ++k) {
    force.row(k) = (less.Inertial(k) - more.Inertial(k)).transpose() / (2.0 * kStep);
  }
  return force;
}

MatrixXd MotorForces(const mjModel& plant, const Channels& channels,
                     const PlantNumber& number, const ObservedMotion& motion) {
  constexpr double kStep = 1e-4;
  AlongMotion once(CopyModel(plant), channels, motion);
  AlongMotion more(Scaled(plant, number, 1.0 + kStep), channels, motion);
  MatrixXd force(motion.samples(), plant.nv);
  for (Index k = 0; k < motion.samples(); ++k) {
    force.row(k) = (more.Motors(k) - once.Motors(k)).transpose() / kStep;
  }
  return force;
}

/// Of a number of a joint, on its own degree of freedom.
VectorXd JointForceOf(const mjModel& plant, const PlantNumber& number, int dof,
                      const ObservedMotion& motion, double still) {
  const int joint = number.element;
  switch (number.kind) {
    case PlantNumberKind::kStiffness: {
      const int address = plant.jnt_qposadr[joint];
      const double rest = plant.qpos_spring[address] - plant.qpos0[address];
      return -plant.jnt_stiffness[joint] *
             (motion.position.row(dof).array() - rest).matrix();
    }
    case PlantNumberKind::kDamping:
      return -plant.dof_damping[dof] * motion.velocity.row(dof);
    case PlantNumberKind::kFriction:
      // What it holds it goes on to hold, whatever the bound.
      return motion.velocity.row(dof).unaryExpr([&](double v) {
        return std::abs(v) < still ? 0.0 : -plant.dof_frictionloss[dof] * Sign(v);
      });
    default:
      return -plant.dof_armature[dof] * motion.own_acceleration.row(dof);
  }
}

}  // namespace

MatrixXd NumberForce(const mjModel& plant, const Channels& channels,
                     const PlantNumber& number, const ObservedMotion& motion,
                     const VectorXd& still) {
  switch (number.kind) {
    case PlantNumberKind::kMass:
    case PlantNumberKind::kInertia:
      return MassForce(plant, channels, number, motion);
    case PlantNumberKind::kCentreX:
    case PlantNumberKind::kCentreY:
    case PlantNumberKind::kCentreZ:
      return CentreForce(plant, channels, number, motion);
    case PlantNumberKind::kGear:
    case PlantNumberKind::kGain:
      return MotorForces(plant, channels, number, motion);
    default: {
      MatrixXd force = MatrixXd::Zero(motion.samples(), plant.nv);
      const int dof = plant.jnt_dofadr[number.element];
      force.col(dof) = JointForceOf(plant, number, dof, motion, still[dof]);
      return force;
    }
  }
}

MatrixXd LatenessForce(const mjModel& plant, const MatrixXd& Gamma,
                       const ObservedMotion& motion) {
  MatrixXd change = MatrixXd::Zero(motion.inputs.rows(), motion.samples());
  const Index n = motion.samples();
  change.rightCols(n - 1) =
      (motion.inputs.leftCols(n - 1) - motion.inputs.rightCols(n - 1)) /
      motion.sample_time;
  const Eigen::Map<const VectorXd> D(plant.dof_damping, plant.nv);
  return (Gamma * change + D.asDiagonal() * motion.own_acceleration).transpose();
}

}  // namespace mjdiag
