#pragma once
// What a motion tells of the inertial and friction numbers of a plant: rows of the regressor
// (inertial_regressor.h) over the noise of their joints, W, with
//
//   condition number of W,   standard deviations sqrt diag (W^T W)^-1.

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "mjdiag/studies/excitation/axis_limits.h"
#include "mjdiag/studies/excitation/fourier_motion.h"
#include "mjdiag/studies/excitation/inertial_regressor.h"

namespace mjdiag {

struct InertialRows {
  Eigen::MatrixXd
      W;  ///< one joint after the other, a column for every number asked for
  Eigen::VectorXd force;  ///< largest magnitude at every joint, of the plant as it is
  bool touches = false;   ///< whether bodies of the plant do anywhere
};

/// @param numbers  places in the regressor's
/// @param noise    of every joint [N, N m]
InertialRows RowsAlong(InertialRegressor& regressor, const JointMotion& motion,
                       const std::vector<Eigen::Index>& numbers,
                       const Eigen::VectorXd& noise);

struct InertialInformation {
  /// Infinite: they are not told apart.
  double condition = std::numeric_limits<double>::infinity();
  Eigen::VectorXd sd;
};

/// @param times  independent values of the motion over those that the rows have
InertialInformation InformationOf(const Eigen::MatrixXd& W, double times);

/// Numbers that motions within the limits can tell apart (base parameters [Gautier 1991]),
/// places in their order: by a QR decomposition with pivots of the forces anywhere within.
std::vector<Eigen::Index> BaseNumbers(InertialRegressor& regressor,
                                      const std::vector<AxisLimits>& limits);

/// What those numbers do not explain of forces along a motion, rms of every joint, each
/// weighted by what that comes to. @param forces  joints x samples
Eigen::VectorXd NoiseBeside(InertialRegressor& regressor, const JointMotion& motion,
                            const std::vector<Eigen::Index>& numbers,
                            const Eigen::MatrixXd& forces);

}  // namespace mjdiag
