#pragma once
// The force that a model lacks at every joint along a measured motion. Beside an observer
// that follows it (observer.h) the truth less the observer, x = [q; v], is to first order
//
//   xt[k+1] = A[k] xt[k] + B[k] f[k] - L[k] e[k],     e[k] = C[k] xt[k] + n[k]
//
// with e known, n the white noise of the sensors, and f[k+1] = f[k] + w[k] a random walk at
// every joint, w white of standard deviation s. Estimated is f given all samples before and
// after, by a Kalman filter and the smoother of H. E. Rauch, F. Tung and C. T. Striebel in
// the form of Bryson and Frazier, as in unknown_input.h, here with a system that moves:
//
//   nu = e - C x,   S = C P C^T + I,   K = A P C^T S^-1,   F = A - K C
//   r[k-1] = C^T S^-1 nu[k] + F^T r[k],                estimate x + P r[k-1]
//   W[k-1] = C^T S^-1 C + F^T W[k] F,                  covariance P - P W[k-1] P
//
// s stands for a bandwidth b [rad a tick], s = z0 b^3, z0 the force that moves a reading by
// its noise in a tick. How noisy readings are against a motion is known roughly only: clocks
// that jitter, torques that are late. n and w are therefore c times that, which leaves K as
// it is, and with c of the largest likelihood of n ticks with m readings each
//
//   -2 ln L = n m ln c^2 + sum ln det S,     c^2 = mean nu^T S^-1 nu / m.
//
// Ticks that a logger has missed or doubled would decide alone over that mean: c is taken
// from the median instead, over that of chi-squared with m degrees of freedom.
//
// b is that of the largest L over octaves, of all joints together first, then of one after
// the other, from four thousand samples; 32 times the bandwidth of the motion at most, rms
// acceleration over rms velocity. What is faster goes with no motion: ripple and noise of a
// measured torque, vibrations of what the model takes for rigid.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct MissingForce {
  std::string joint;
  std::string unit;        ///< "N" or "N m"
  Eigen::VectorXd value;   ///< of every sample
  double rms = 0.0;        ///< of value
  double sd = 0.0;         ///< of its error, mean square along the motion
  double bandwidth = 0.0;  ///< b over 2 pi and the tick [Hz]
};

/// 32 times the bandwidth of the motion [Hz]: what is faster goes with no motion.
double FastestForce(const MeasuredRun& run);

/// Degrees of freedom with a force of their own: those that are driven, as many as there are
/// sensors; all of them where that many sensors are there.
std::vector<Eigen::Index> ForcedDofs(const Machine& machine);

/// At the joints that are driven, as many as there are sensors; at all of them where that
/// many sensors are there.
/// @param observer     one that follows the run, else InputError
/// @param innovations  ny x samples, as FollowRun gives them
std::vector<MissingForce> MissingForces(const Machine& machine, const MeasuredRun& run,
                                        const Observer& observer,
                                        const Eigen::MatrixXd& innovations);

}  // namespace mjdiag
