#pragma once
// Unknown inputs z in the state x of a linear system whose outputs e are known too,
//
//   x[k+1] = A x[k] - L e[k] + w[k],     e[k] = C x[k] + n[k],     x = [xt; z]
//
// n white of unit variance, w white of covariance Q and s^2 for every input. Estimated
// is z given all samples before and after, by a Kalman filter and the smoother of H. E.
// Rauch, F. Tung and C. T. Striebel, "Maximum likelihood estimates of linear dynamic
// systems", AIAA Journal 3 (1965), in the form of Bryson and Frazier, which needs no
// inverse of the covariance. With the stationary P of (A, C) and F = A - K C,
//
//   nu[k] = e[k] - C x[k],   x[k+1] = A x[k] - L e[k] + K nu[k],   S = C P C^T + I
//   r[k-1] = C^T S^-1 nu[k] + F^T r[k],     estimate[k] = x[k] + P r[k-1]
//   covariance  P - P W P,                  W = C^T S^-1 C + F^T W F
//
// How fast an input may change decides how much noise is left in its estimate and how
// much of it is smoothed away. s follows the data: it is the s of the largest
// likelihood of the innovations nu over a grid in bandwidth b [rad a tick], s = z0 b^p,
// all inputs alike first, then one after the other, down to steps of a quarter octave.
//
// Both ends: the state at the first sample is free (a prior 10^4 times the noise, taken
// out exactly by the method of P. de Jong, "The diffuse Kalman filter", Annals of
// Statistics 19, 1991), so that a constant input is there from the first sample on. At
// both ends there are samples on one side only: the error grows to that of the filter,
// which `edge` samples away is no longer felt.

#include <Eigen/Core>
#include <vector>

namespace mjdiag {

/// xt and the unknown inputs z, in units of the sensor noise: readings in multiples of
/// their noise r, positions of the smallest r, velocities of that in a tick, z of z0.
struct AugmentedSystem {
  Eigen::MatrixXd A;
  Eigen::MatrixXd C;
  Eigen::MatrixXd L;         ///< known input: x+ = A x - L e
  Eigen::MatrixXd Q;         ///< of the white forces on the actuators
  Eigen::VectorXd unit;      ///< z0 of every unknown input
  double power = 0.0;        ///< p of s = z0 b^p
  double slowest = 0.0;      ///< smallest b [rad a tick]
  Eigen::Index fastest = 0;  ///< largest i of b = slowest 2^i
  Eigen::Index inputs() const { return unit.size(); }
};

/// The inputs at their bandwidths of largest likelihood.
struct SmoothedInputs {
  Eigen::MatrixXd value;      ///< inputs x samples, in z0
  Eigen::VectorXd sd;         ///< stationary, of the error of value, in z0
  Eigen::VectorXd bandwidth;  ///< b [rad a tick]
  /// Samples at each end over which the error is larger than sd by more than a fifth.
  std::vector<Eigen::Index> edge;
};

/// @param e  ny x samples, in units of the noise
/// NumericalError if the covariance does not converge.
SmoothedInputs SmoothInputs(const AugmentedSystem& system, const Eigen::MatrixXd& e);

}  // namespace mjdiag
