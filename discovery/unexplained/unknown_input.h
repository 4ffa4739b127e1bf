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
// all samples before and after, with the s of the largest likelihood (input_smoother.h).
// It is found as a bandwidth b [rad a tick], which stands for s = z0 b^p, where z0 is
// the force that moves a reading by its noise in a tick and p = 3, or the noise of the
// sensor and p = 1: there a random walk through the inertia of an axis and the noise
// balance. The slowest is three cycles over the record; it is what noise alone mostly
// gives.
//
// So that motions which nothing holds have a stationary covariance, the actuators
// have a white force noise of the slowest bandwidth (observer.h says what that is).
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
