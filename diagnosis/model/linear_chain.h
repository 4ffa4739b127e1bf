#pragma once
// The analytic linear model of a machine: a tree of rigid bodies on slides and hinges
// with springs and dampers, written down by hand in a small file and linearised here
// from first principles, without MuJoCo. It is the independent witness against which
// the linearised MuJoCo model is tested.
//
// For small motion about the reference configuration, with v_i and w_i the rows of the
// velocity of body i's centre of mass and of its angular velocity per joint speed:
//   M = sum_i m_i V_i^T V_i + W_i^T I_i W_i,   D = diag(d),   K = diag(k) + K_gravity
//   Gamma: virtual work of each actuator's force pair,  b: motion along each scale.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"

namespace mjdiag {

struct ChainJoint {
  std::string name;
  bool hinge = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector, world frame
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< a point on a hinge's axis [m]
  double stiffness = 0.0;                           ///< [N/m or N m/rad]
  double damping = 0.0;                             ///< [N s/m or N m s/rad]
};

struct ChainBody {
  std::string name;
  std::string parent;              ///< empty: the world
  std::vector<ChainJoint> joints;  ///< from the parent outwards
  double mass = 0.0;               ///< [kg]
  Eigen::Vector3d centre =
      Eigen::Vector3d::Zero();  ///< centre of mass, world frame [m]
  Eigen::Vector3d inertia =
      Eigen::Vector3d::Zero();  ///< principal, along world axes [kg m^2]
};

/// A force (or torque) pair: +1 on `body`, -1 on `base`, along `axis` through `point`.
/// The same description read the other way is a sensor: relative motion of body and
/// base along `axis` at `point`.
struct ChainPort {
  std::string name;
  std::string body;
  std::string base;  ///< empty: the world
  bool rotational = false;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double gain = 1.0;
};

struct LinearChain {
  std::vector<ChainBody> bodies;  ///< parents first
  std::vector<ChainPort> actuators;
  std::vector<ChainPort> sensors;
  double gravity = 9.81;  ///< downwards along z [m/s^2]
};

/// InputError names a body or port that refers to an unknown body.
MechanicalModel Linearize(const LinearChain& chain);

}  // namespace mjdiag
