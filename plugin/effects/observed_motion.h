#pragma once
// The motion of a machine along a record, as an observer has it: what the forces of an
// effect are computed from.

#include <Eigen/Core>

namespace mjdiag {

struct ObservedMotion {
  double sample_time = 0.0;      ///< [s]
  Eigen::VectorXd time;          ///< [s] since the start of the record, samples
  Eigen::MatrixXd position;      ///< nv x samples, from qpos0
  Eigen::MatrixXd velocity;      ///< nv x samples
  Eigen::MatrixXd acceleration;  ///< nv x samples
  /// What the model itself does where it is, without what pulls it to the measurement, nv x
  /// samples: M a is all of its forces. A machine with every mass and every force twice as
  /// large moves the same, which derivatives by those numbers show with this one only.
  Eigen::MatrixXd own_acceleration;
  Eigen::MatrixXd inputs;   ///< actuators x samples
  Eigen::MatrixXd outputs;  ///< sensors x samples
  Eigen::Index samples() const { return position.cols(); }
};

}  // namespace mjdiag
