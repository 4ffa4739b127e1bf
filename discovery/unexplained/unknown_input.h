#pragma once
// Where is the model wrong, and by how much at every moment? The innovations e of an
// observer beside the plant (observer.h) hold what the model lacks: with forces f that
// it does not know, errors d of the readings and the white noise n of the sensors,
//
//   xt[k+1] = (A - L C) xt[k] + B_f f[k] - L (d[k] + n[k])
//           = A xt[k] + B_f f[k] - L e[k],              e[k] = C xt[k] + d[k] + n[k]
//
// xt: truth minus observer, x = [q; v]. In the second form L e is known and n white, so
// that the unknown inputs can join the state (augmented-state input estimation). Each
// is a random walk z that forgets within the length N of the record,
//
//   z[k+1] = exp(-1/N) z[k] + w[k],        w white of standard deviation s
//
// with z = f (UnexplainedForces) or z = d (UnexplainedReadings). Estimated is z given
// all samples before and after, by a Kalman filter and the smoother of H. E. Rauch, F.
// Tung and C. T. Striebel, "Maximum likelihood estimates of linear dynamic systems",
// AIAA Journal 3 (1965), in the form of Bryson and Frazier, which needs no inverse of
// the covariance. With the stationary P of the augmented (A, C) and F = A - K C,
//
//   nu[k] = e[k] - C x[k],   x[k+1] = A x[k] - L e[k] + K nu[k],   S = C P C^T + R
//   r[k-1] = C^T S^-1 nu[k] + F^T r[k],     estimate[k] = x[k] + P r[k-1]
//   covariance  P - P W P,                  W = C^T S^-1 C + F^T W F
//
// How fast an input may change decides how much noise is left in its estimate and how
// much of it is smoothed away. s follows the data: it is the s of the largest
// likelihood of the innovations over a grid in bandwidth, all inputs alike first, then
// one after the other, down to steps of a quarter octave. The bandwidth b [rad a tick]
// stands for s = z0 b^p, where z0 is the force that moves a reading by its noise in a
// tick and p = 3, or the noise of the sensor and p = 1: there a random walk through the
// inertia of an axis and the noise balance. The slowest is three cycles over the
// record; it is what noise alone mostly gives.
//
// So that motions which nothing holds have a stationary P, the actuators have a white
// force noise of the slowest bandwidth (observer.h says what that is).
//
// Both ends: the state at the first sample is free (a prior 10^4 times the noise of the
// sensors, taken out exactly by the method of P. de Jong, "The diffuse Kalman filter",
// Annals of Statistics 19, 1991), so that a constant force is there from the first
// sample on. At both ends there are samples on one side only: the error grows to that
// of the filter, which `edge` samples away is no longer felt.
//
// Limits: an error of a reading and a slow motion of an axis that nothing holds cannot
// be told apart; sd then says so. A joint that was left out of the list has no force:
// it goes to the joints in the list. Steps are smoothed over a bandwidth; there the
// estimate is further off than sd.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mjdiag {

struct MechanicalModel;
struct Observer;

struct UnknownSignal {
  std::string site;       ///< joint or sensor
  std::string unit;       ///< of value and sd
  Eigen::VectorXd value;  ///< one for every sample
  double sd = 0.0;        ///< stationary standard deviation of the error of value
  /// Samples at each end over which that is larger by more than a fifth.
  Eigen::Index edge = 0;
  double bandwidth = 0.0;  ///< b over 2 pi and the tick [Hz]
};

/// The generalised force that the model lacks at every one of `joints`, held over a
/// tick, if forces at these joints are all that the model lacks.
/// @param innovations  ny x samples, at least 100 samples, as FollowRun gives them
/// @param joints       names among model.coordinates, at least one and at most ny
/// @param units        of the forces, "N" or "N m"; none: units are left empty
/// InputError on a joint that the model lacks and on shapes that do not fit;
/// NumericalError if the covariance does not converge, as with two joints whose slow
/// forces move all sensors alike.
std::vector<UnknownSignal> UnexplainedForces(
    const MechanicalModel& model, const Observer& observer, double step, int substeps,
    const Eigen::MatrixXd& innovations, const std::vector<std::string>& joints,
    const std::vector<std::string>& units = {});

/// The error of the reading of every sensor beyond its white noise, if there are no
/// forces that the model lacks.
/// @param units  of the sensors; none: units are left empty
std::vector<UnknownSignal> UnexplainedReadings(
    const MechanicalModel& model, const Observer& observer, double step, int substeps,
    const Eigen::MatrixXd& innovations, const std::vector<std::string>& units = {});

}  // namespace mjdiag
