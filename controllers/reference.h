#pragma once
// The reference that the axes of a machine follow, with the derivatives that
// feedforward needs, sampled at the control rate.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mjdiag {

/// The reference of one axis at one control tick (SI units, m or rad).
struct ReferenceSample {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  double snap = 0.0;
};

/// One axis over a run; all vectors have the same length.
struct AxisReference {
  std::string axis;
  Eigen::VectorXd position;      ///< [m or rad]
  Eigen::VectorXd velocity;      ///< [m/s]
  Eigen::VectorXd acceleration;  ///< [m/s^2]
  Eigen::VectorXd snap;          ///< [m/s^4]

  ReferenceSample At(Eigen::Index k) const {
    return {position[k], velocity[k], acceleration[k], snap[k]};
  }
};

/// All axes of a run.
struct Reference {
  double sample_time = 0.0;  ///< [s]
  std::vector<AxisReference> axes;

  Eigen::Index samples() const { return axes.empty() ? 0 : axes[0].position.size(); }
};

/// A reference known by its positions only (a measured one): derivatives by central
/// differences of 3 (velocity, acceleration) and 5 samples (snap); at the ends the
/// first and last positions are held. InputError if the sample time is not positive.
AxisReference DifferentiateReference(const std::string& axis,
                                     const Eigen::VectorXd& position,
                                     double sample_time);

}  // namespace mjdiag
