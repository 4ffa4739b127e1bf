#pragma once
// A state estimator for the replay of measured inputs. Driven by the measured input
// alone, a simulation of an axis that integrates drifts away with the smallest error of
// the model; pulled back by a constant gain at every control tick it stays beside the
// measurement, and what it has to be pulled back by tells what the model gets wrong:
//
//   x[k+1] = f(x[k], u[k]) + L e[k],     e[k] = y[k] - g(x[k])       (innovations)
//
// f: one control tick of the nonlinear plant with everything that is put into it. L is
// the stationary Kalman predictor gain of the linear tick model x+ = A x + B u for
// white force noise on the actuators,
//
//   P = A P A^T - A P C^T (C P C^T + R)^-1 C P A^T + B Q B^T,  L = A P C^T (C P C^T +
//   R)^-1
//
// with R the measured sensor noise and Q such that an actuator's force noise and its
// sensor's noise balance at the bandwidth asked for: of a mass m, q = m w^2 r. Errors
// of the model then leave traces in e, as a linear filter (A - L C) has them
// (error_dynamics.h); with the true model e is the sensor noise, freed of what lies
// below that bandwidth.
//
// Where a machine leaves its rest so far that this gain is another machine's (motion_path.h
// says when), A, B, C and Q are those of its first order along the measured motion, and P
// and L follow the recursion
//
//   P[k+1] = A[k] P[k] A[k]^T + B[k] Q[k] B[k]^T - L[k] C[k] P[k] A[k]^T
//   L[k] = A[k] P[k] C[k]^T (C[k] P[k] C[k]^T + R)^-1
//
// from the stationary P of the first stretch on. It is the extended Kalman filter but for
// the place of its first order, which is where the readings are and not where the estimate
// is: the gain does not depend on what is tried beside the record, and an estimate that is
// off does not spoil it. The errors die away exponentially however fast A changes, where
// the motion is seen by the sensors and stirred by the actuators (B. D. O. Anderson, J. B.
// Moore, "Detectability and stabilizability of time-varying discrete-time linear systems",
// SIAM J. Control and Optimization 19, 1981); stationary gains, one for every
// configuration, would promise that for slow motion only. L is kept once a stretch.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

class Machine;
struct MeasuredRun;
struct MotionPath;

/// Gains along a motion.
struct FollowingGain {
  std::shared_ptr<const MotionPath> path;
  std::vector<Eigen::MatrixXd> L;  ///< of every stretch, 2 nq x ny
};

struct Observer {
  StateSpace tick;           ///< A, B, C of the linear tick, x = [q; v]
  Eigen::MatrixXd L;         ///< 2 nq x ny
  Eigen::MatrixXd P;         ///< of the predicted state, 2 nq x 2 nq
  Eigen::VectorXd noise_sd;  ///< r of every sensor [unit]
  /// Standard deviation of e if sensor noise is all there is, ny.
  Eigen::VectorXd innovation_sd;
  /// C P C^T + R, of e if there is that force noise, too, ny x ny.
  Eigen::MatrixXd innovation_covariance;
  double bandwidth = 0.0;  ///< [Hz]
  /// Of a machine that leaves its rest; null: L holds at all times. Where there is one, L
  /// and P are those of the first stretch, and both of innovations the means along it.
  std::shared_ptr<const FollowingGain> following{};
  Eigen::VectorXd gain_factors{};  ///< what ScaleGain has put in; empty: nothing

  /// L at a sample of the run.
  const Eigen::MatrixXd& GainAt(Eigen::Index sample) const;
  /// C at it.
  const Eigen::MatrixXd& OutputsAt(Eigen::Index sample) const;
};

/// @param noise_sd   r, ny, all > 0
/// @param bandwidth  [Hz], above 0 and below a quarter of the control rate
/// InputError on values out of range; NumericalError if no stable observer is found
/// (a rigid motion that no sensor sees).
Observer DesignObserver(const MechanicalModel& model, double step, int substeps,
                        const Eigen::VectorXd& noise_sd, double bandwidth);

/// The observer of a run: that of the machine at rest if the run stays near it, else one
/// that follows the measured motion. Errors as above.
/// @param path  along that run, which the observer is to follow anyhow; null: none known
Observer DesignObserver(const Machine& machine, const MeasuredRun& run,
                        const Eigen::VectorXd& noise_sd, double bandwidth,
                        std::shared_ptr<const MotionPath> path = nullptr);

/// That observer on another run of the machine.
Observer OnRun(const Observer& observer, const Machine& machine,
               const MeasuredRun& run);

/// Gain of every sensor times a factor, as of one that is read every so many ticks: as much
/// more at a time it holds the same. What of innovations is fed back grows with it.
/// @param factors  ny; empty: 1
void ScaleGain(const Eigen::VectorXd& factors, Observer& observer);

/// Autocorrelation of the innovations of a sensor at 1 .. lags ticks if sensor noise is all
/// there is: they are coloured, for the gain is made for a machine with force noise. With
/// F = A - L C and S the covariance of the state by that noise alone,
///
///   rho_l = C F^(l-1) (F S C^T - L R) / (C S C^T + R)
///
/// Along a motion numerator and denominator are means over it.
Eigen::VectorXd NoiseCorrelation(const Observer& observer, Eigen::Index sensor,
                                 Eigen::Index lags);

}  // namespace mjdiag
