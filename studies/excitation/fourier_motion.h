#pragma once
// A motion of every joint by a Fourier series over its whole duration T, at rest at its
// begin and end, so that a machine can go it again and again:
//
//   q(t) = o + s sum over l of a_l sin(l w t) + b_l cos(l w t),   w = 2 pi / T,
//   q'(0) = 0: sum of l a_l = 0,   q''(0) = 0: sum of l^2 b_l = 0.
//
// How large it may be, s, follows from its shape (a, b) and the limits of the joint, and o
// from where in what is left of the range it stands. (J. Swevers et al., "Optimal robot
// excitation and identification", IEEE Trans. Robotics and Automation 13, 1997.)

#include <Eigen/Core>
#include <vector>

#include "mjdiag/studies/excitation/axis_limits.h"

namespace mjdiag {

/// Of every joint and sample, joints x samples.
struct JointMotion {
  Eigen::MatrixXd position;
  Eigen::MatrixXd velocity;
  Eigen::MatrixXd acceleration;
};

class FourierMotion {
 public:
  /// @param harmonics  at least 2
  /// @param limits     of every joint: range of positions, velocity and acceleration, finite
  /// @param samples    instants from 0 to the duration
  FourierMotion(double duration, int harmonics, std::vector<AxisLimits> limits,
                Eigen::Index samples);

  /// Numbers of a motion: of every joint its shape, where it stands in what is left of its
  /// range (0: lowest, 1: highest) and the share of the largest size, these two brought
  /// into 0 .. 1.
  Eigen::Index parameters() const {
    return parameters_of_a_joint() * static_cast<Eigen::Index>(limits_.size());
  }
  Eigen::Index parameters_of_a_joint() const { return fine_.position.cols() + 2; }
  /// As large as the limits allow, times the share.
  JointMotion At(const Eigen::VectorXd& parameters) const;

 private:
  /// Position, velocity and acceleration of every shape, samples x shapes.
  struct Basis {
    Eigen::MatrixXd position, velocity, acceleration;
  };
  static Basis MakeBasis(double duration, int harmonics, Eigen::Index samples);

  std::vector<AxisLimits> limits_;
  Basis wanted_;
  Basis fine_;  // on which peaks are looked for
};

}  // namespace mjdiag
