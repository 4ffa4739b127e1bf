#include "mjdiag/plugin/effects/number_forces.h"

#include <cmath>
#include <utility>

#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/plugin/plant/tendon_moment.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A plant that is put where a motion is.
class AlongMotion {
 public:
  /// @param plant  the one whose motion it is, or one with another number
  /// @param qpos0  of the one whose motion it is
  AlongMotion(ModelPtr plant, const mjtNum* qpos0, std::span<const int> actuators,
              const ObservedMotion& motion)
      : plant_(std::move(plant)),
        data_(MakeData(*plant_)),
        motion_(motion),
        actuators_(actuators),
        origin_(VectorXd::Map(qpos0, plant_->nv)) {}

  /// M q'' + c + g, without rotors.
  VectorXd Inertial(Index k) {
    Move(k);
    mj_comVel(plant_.get(), data_.get());
    return Accelerated();
  }
  VectorXd Motors(Index k) {
    Act(k);
    return VectorXd::Map(data_->qfrc_actuator, plant_->nv);
  }
  /// All that acts, less what it accelerates.
  VectorXd Balance(Index k) {
    Act(k);
    return VectorXd::Map(data_->qfrc_actuator, plant_->nv) +
           VectorXd::Map(data_->qfrc_passive, plant_->nv) - Accelerated();
  }
  /// Of a tendon, how fast it grows longer by the joints.
  VectorXd MomentOf(int tendon, Index k) {
    Move(k);
    mj_tendon(plant_.get(), data_.get());
    return TendonMoment(*plant_, *data_, tendon);
  }

 private:
  void Move(Index k) {
    const int nv = plant_->nv;
    VectorXd::Map(data_->qpos, nv) = origin_ + motion_.position.col(k);
    VectorXd::Map(data_->qvel, nv) = motion_.velocity.col(k);
    VectorXd::Map(data_->qacc, nv) = motion_.own_acceleration.col(k);
    mj_kinematics(plant_.get(), data_.get());
    mj_comPos(plant_.get(), data_.get());
  }
  void Act(Index k) {
    Move(k);
    for (std::size_t u = 0; u < actuators_.size(); ++u) {
      if (actuators_[u] < 0) continue;
      data_->ctrl[actuators_[u]] = motion_.inputs(static_cast<Index>(u), k);
    }
    mj_tendon(plant_.get(), data_.get());
    mj_transmission(plant_.get(), data_.get());
    mj_fwdVelocity(plant_.get(), data_.get());
    mj_fwdActuation(plant_.get(), data_.get());
  }
  VectorXd Accelerated() {
    VectorXd force(plant_->nv);
    mj_rne(plant_.get(), data_.get(), 1, force.data());
    return force;
  }

  ModelPtr plant_;
  DataPtr data_;
  const ObservedMotion& motion_;
  std::span<const int> actuators_;
  VectorXd origin_;
};

ModelPtr Scaled(const mjModel& plant, const ModelParameter& number, double factor) {
  ModelPtr scaled = CopyModel(plant);
  if (number.kind == ModelParameterKind::kRef) {
    ScaleNumbers(*scaled, {{number, factor}});
  } else {
    Scale(*scaled, number, factor);
  }
  return scaled;
}

MatrixXd MassForce(const mjModel& plant, std::span<const int> actuators,
                   const ModelParameter& number, const ObservedMotion& motion) {
  AlongMotion once(CopyModel(plant), plant.qpos0, actuators, motion);
  AlongMotion twice(Scaled(plant, number, 2.0), plant.qpos0, actuators, motion);
  MatrixXd force(motion.samples(), plant.nv);
  for (Index k = 0; k < motion.samples(); ++k) {
    force.row(k) = (once.Inertial(k) - twice.Inertial(k)).transpose();
  }
  return force;
}

/// By a difference about it of what acts, whatever it is.
/// @param force  of a plant at a sample
template <typename Force>
MatrixXd DifferenceOf(const mjModel& plant, std::span<const int> actuators,
                      const ModelParameter& number, const ObservedMotion& motion,
                      const Force& force) {
  constexpr double kStep = 1e-4;
  AlongMotion less(Scaled(plant, number, std::exp(-kStep)), plant.qpos0, actuators,
                   motion);
  AlongMotion more(Scaled(plant, number, std::exp(kStep)), plant.qpos0, actuators,
                   motion);
  MatrixXd change(motion.samples(), plant.nv);
  for (Index k = 0; k < motion.samples(); ++k) {
    change.row(k) = (force(more, k) - force(less, k)).transpose() / (2.0 * kStep);
  }
  return change;
}

/// What it holds it goes on to hold, whatever the bound.
double Slides(double velocity, double still) {
  return std::abs(velocity) < still ? 0.0 : Sign(velocity);
}

MatrixXd TendonFriction(const mjModel& plant, int tendon, const ObservedMotion& motion,
                        const VectorXd& still) {
  AlongMotion along(CopyModel(plant), plant.qpos0, {}, motion);
  MatrixXd force(motion.samples(), plant.nv);
  for (Index k = 0; k < motion.samples(); ++k) {
    const VectorXd moment = along.MomentOf(tendon, k);
    const double slides =
        Slides(moment.dot(motion.velocity.col(k)), moment.cwiseAbs().dot(still));
    force.row(k) = -plant.tendon_frictionloss[tendon] * slides * moment.transpose();
  }
  return force;
}

/// Of a number of a joint, on its own degree of freedom.
VectorXd JointForceOf(const mjModel& plant, const ModelParameter& number, int dof,
                      const ObservedMotion& motion, double still) {
  const int joint = number.element;
  switch (number.kind) {
    case ModelParameterKind::kStiffness: {
      const int address = plant.jnt_qposadr[joint];
      const double rest = plant.qpos_spring[address] - plant.qpos0[address];
      return -plant.jnt_stiffness[joint] *
             (motion.position.row(dof).array() - rest).matrix();
    }
    case ModelParameterKind::kDamping:
      return -plant.dof_damping[dof] * motion.velocity.row(dof);
    case ModelParameterKind::kFriction:
      return motion.velocity.row(dof).unaryExpr(
          [&](double v) { return -plant.dof_frictionloss[dof] * Slides(v, still); });
    default:
      return -plant.dof_armature[dof] * motion.own_acceleration.row(dof);
  }
}

}  // namespace

VectorXd StillSpeeds(const mjModel& plant, const VectorXd& reading_noise,
                     double sample_time) {
  constexpr double kShare = 0.02;
  return VectorXd::Constant(plant.nv, kShare * reading_noise.minCoeff() / sample_time);
}

MatrixXd NumberForce(const mjModel& plant, std::span<const int> actuators,
                     const ModelParameter& number, const ObservedMotion& motion,
                     const VectorXd& still) {
  const auto by_difference = [&](auto force) {
    return DifferenceOf(plant, actuators, number, motion, force);
  };
  switch (number.kind) {
    case ModelParameterKind::kMass:
    case ModelParameterKind::kInertia:
      return MassForce(plant, actuators, number, motion);
    case ModelParameterKind::kCentreX:
    case ModelParameterKind::kCentreY:
    case ModelParameterKind::kCentreZ:
      return by_difference(
          [](AlongMotion& at, Index k) -> VectorXd { return -at.Inertial(k); });
    case ModelParameterKind::kGear:
    case ModelParameterKind::kGain:
    case ModelParameterKind::kKp:
    case ModelParameterKind::kKv:
      return by_difference(
          [](AlongMotion& at, Index k) -> VectorXd { return at.Motors(k); });
    case ModelParameterKind::kTendonStiffness:
    case ModelParameterKind::kTendonDamping:
    case ModelParameterKind::kRef:
      return by_difference(
          [](AlongMotion& at, Index k) -> VectorXd { return at.Balance(k); });
    case ModelParameterKind::kTendonFriction:
      return TendonFriction(plant, number.element, motion, still);
    case ModelParameterKind::kStiffness:
    case ModelParameterKind::kDamping:
    case ModelParameterKind::kFriction:
    case ModelParameterKind::kArmature:
      break;
  }
  MatrixXd force = MatrixXd::Zero(motion.samples(), plant.nv);
  const int dof = plant.jnt_dofadr[number.element];
  force.col(dof) = JointForceOf(plant, number, dof, motion, still[dof]);
  return force;
}

MatrixXd DelayForce(const mjModel& plant, const MatrixXd& Gamma,
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
