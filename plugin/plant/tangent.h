#pragma once
// First order of the control ticks of a run of the nonlinear plant.
//
// One substep of h (velocity first, as MuJoCo's Euler integrator has it), at the place
// where the run is,
//
//   v' = v + h (M + h D)^-1 M W^-1 (f - K q - D v - B_s v),    q' = q + h v'
//
// with W = M + sum over the joints that dry friction holds of r e e^T. Such a joint is
// a stiff damper in MuJoCo: a force r (a + b v) against its motion, and B_s holds r b.
// A joint that slides has a constant friction force, which the first order does not
// see. M and which joints stick are those of every single substep: a machine whose
// guides stick half of the time is another machine then. So is one whose motors are off:
// K and D lack the motors' own part.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/plant/motor_force.h"

namespace mjdiag {

/// First order of a control tick, x' = A x + B f, y = C x + D f: of deviations x = [q; v;
/// act] in tangent coordinates from where the machine is, with forces f on every degree of
/// freedom that are held over the tick. Readings of positions and velocities are those at
/// its start; of accelerations and forces, which alone have D, those at its end.
struct TickTangent {
  Eigen::MatrixXd A;    ///< ns x ns, ns = 2 nv + na
  Eigen::MatrixXd B;    ///< ns x nv
  Eigen::MatrixXd C{};  ///< ny x ns; empty where nobody has asked for it
  Eigen::MatrixXd D{};  ///< ny x nv
};

/// Spring of the joint of every degree of freedom, nv.
Eigen::VectorXd JointStiffness(const mjModel& plant);

class TangentRecorder {
 public:
  /// @param plant  the nominal one, which `model` is the linear model of
  TangentRecorder(const mjModel& plant, const MechanicalModel& model);

  /// After every substep. @param plant  of the run, changes and all
  /// @param off  actuators that are an open circuit in it
  void Substep(const mjModel& plant, const mjData& data, std::span<const int> off = {});
  /// The tick that the substeps since the last call make.
  TickTangent EndTick();

 private:
  /// Joints that stick, with r and r b.
  using Held = std::map<int, std::pair<double, double>>;
  /// v' = Q q + V v + F f.
  struct Map {
    Eigen::MatrixXd Q, V, F;
  };
  bool MassChanged(const mjModel& plant, const mjData& data);
  const Map& MapOf(const mjModel& plant, const Held& held);
  /// Puts the part of the motors that are on into K and D.
  void Switch(const mjModel& plant, const mjData& data, std::span<const int> off);

  Eigen::VectorXd springs_;  // of the nominal plant
  Eigen::VectorXd dampers_;
  MotorBias all_motors_;       // at qpos0, none off
  Eigen::MatrixXd stiffness_;  // what is not of springs in the joints nor of motors
  Eigen::MatrixXd damping_;    // what is not of dampers in the joints nor of motors
  MotorBias motors_;           // of those that are on
  std::vector<int> off_;
  std::vector<mjtNum> packed_mass_;
  Eigen::MatrixXd mass_;
  std::map<Held, Map> known_;  // with that mass
  TickTangent tick_;
};

}  // namespace mjdiag
