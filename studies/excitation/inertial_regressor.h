#pragma once
// The forces of a plant with open chains of joints are linear in its numbers:
//
//   tau = Y(q, q', q'') theta
//
// theta: of every body its mass m, its first moments m c and its inertia I about the origin
// of its frame, and of every joint its rotor inertia, viscous and dry friction. Of a body
// whose frame turns with w, and whose origin has the acceleration a less gravity, all in
// that frame,
//
//   force on it   f = m a + (S(w') + S(w) S(w)) m c
//   about origin  n = S(m c) a + I w' + S(w) I w,    tau = J_v^T f + J_w^T n.
//
// (C. G. Atkeson, C. H. An, J. M. Hollerbach, "Estimation of inertial parameters of
// manipulator loads and links", Int. J. Robotics Research 5, 1986.)

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

class InertialRegressor {
 public:
  /// InputError if a joint is neither a hinge nor a slide.
  explicit InertialRegressor(const mjModel& model);

  /// "mass@link3", "moment_x@link3" [kg m], "inertia_xy@link3" [kg m^2], then
  /// "armature@joint3", "damping@joint3", "friction@joint3".
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& units() const { return units_; }
  Eigen::Index numbers() const { return static_cast<Eigen::Index>(names_.size()); }
  Eigen::Index joints() const { return model_->nv; }
  /// theta of the plant as it is given.
  Eigen::VectorXd Values() const;
  /// Y, joints x numbers. @param position, velocity, acceleration  of every joint
  Eigen::MatrixXd At(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity,
                     const Eigen::VectorXd& acceleration);
  /// Whether bodies of the plant touch at the position of the last At.
  bool Touches();

 private:
  ModelPtr model_;
  DataPtr data_;
  std::vector<int> bodies_;
  std::vector<std::string> names_;
  std::vector<std::string> units_;
};

}  // namespace mjdiag
