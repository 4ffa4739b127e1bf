#pragma once
// The coordinates x in which a fit varies its parameters theta: those in which steps are
// short or long by what is known of the parameters beforehand, and in which what acts
// alike lies on a straight line.
//
//   theta = u x          u the spread that is expected, else the size that it has
//   theta = exp(u x)     of what is above 0 and multiplies or divides: factors, lengths
//                        and velocities over which a law bends, durations. A motor of
//                        half the force and a machine of twice the mass with twice the
//                        friction are the same; the logs of the numbers lie on a line.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"

namespace mjdiag {

/// What a parameter is compared with: steps of differences are small beside it.
/// @param duration  of the record [s]
double ScaleOf(const FitParameter& parameter, double value, double duration);

class FitCoordinates {
 public:
  /// theta itself.
  static FitCoordinates Plain(Eigen::Index size);
  /// @param theta  about which values are, within their bounds
  static FitCoordinates About(const std::vector<FitParameter>& parameters,
                              const Eigen::VectorXd& theta, double duration);

  Eigen::VectorXd FromTheta(const Eigen::VectorXd& theta) const;
  Eigen::VectorXd ToTheta(const Eigen::VectorXd& x) const;
  /// d theta / d x, every parameter by its own coordinate.
  Eigen::VectorXd SlopeAt(const Eigen::VectorXd& theta) const;
  /// Of one parameter; infinite where it has no such end.
  double Bound(Eigen::Index i, double theta) const;

 private:
  Eigen::VectorXd units_;
  std::vector<bool> is_log_;
};

}  // namespace mjdiag
