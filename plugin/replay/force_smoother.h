#pragma once
// The forces that a machine lacked, given all readings before and after: the smoother of
// H. E. Rauch, F. Tung and C. T. Striebel in the form of Bryson and Frazier, behind the filter
// with latent forces (force_filter.h), reading by reading,
//
//   r <- F^T r                            through a tick,
//   r <- r + c (e / S - K^T r),           through a reading y = c z + noise,
//   z + P r                               smoothed, z and P those before the readings
//
// and with W <- F^T W F, W <- (I - K c^T)^T W (I - K c^T) + c c^T / S the covariance
// P - P W P. What is white of the missing force is white^2 B^T r behind the tick.

#include <Eigen/Core>

#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

struct SmoothedForces {
  Eigen::MatrixXd value;  ///< what lasts and what is white, nf x samples [N, N m]
  Eigen::VectorXd sd;     ///< of the error of what lasts, mean square along the run
  /// Where the records began, less where the path begins, ns x records.
  Eigen::MatrixXd start;
};

SmoothedForces SmoothForces(const FilterPath& path);

}  // namespace mjdiag
