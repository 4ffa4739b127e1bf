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

#include <Eigen/Core>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

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
};

/// @param noise_sd   r, ny, all > 0
/// @param bandwidth  [Hz], above 0 and below a quarter of the control rate
/// InputError on values out of range; NumericalError if no stable observer is found
/// (a rigid motion that no sensor sees).
Observer DesignObserver(const MechanicalModel& model, double step, int substeps,
                        const Eigen::VectorXd& noise_sd, double bandwidth);

}  // namespace mjdiag
