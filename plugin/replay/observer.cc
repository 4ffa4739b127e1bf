#include "mjdiag/plugin/replay/observer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mjdiag/plugin/replay/riccati.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Standard deviation of the force noise on every actuator [unit of u].
VectorXd ForceNoise(const MechanicalModel& model, const VectorXd& noise_sd,
                    double bandwidth) {
  const double omega = 2.0 * std::numbers::pi * bandwidth;
  // Acceleration of every sensor by a unit of every actuator.
  const MatrixXd gain = model.b.transpose() * Solve(model.M, model.Gamma);
  const MatrixXd seen = noise_sd.cwiseInverse().asDiagonal() * gain.cwiseAbs();
  VectorXd sd(gain.cols());
  for (Index u = 0; u < gain.cols(); ++u) {
    const double strongest = seen.col(u).maxCoeff();
    sd[u] = strongest > 0.0 ? omega * omega / strongest : 0.0;
  }
  return sd;
}

/// Covariance of the predicted state less the true one, by sensor noise alone.
MatrixXd StateByNoise(const StateSpace& tick, const MatrixXd& L,
                      const VectorXd& noise_sd) {
  const MatrixXd state = L * noise_sd.asDiagonal();
  const MatrixXd F = tick.A - L * tick.C;
  // Sum of C F^k L by doubling of the controllability Gramian.
  MatrixXd gramian = state * state.transpose();
  MatrixXd power = F;
  for (int i = 0; i < 40; ++i) {
    const MatrixXd added = power * gramian * power.transpose();
    gramian += added;
    power = power * power;
    if (added.norm() <= 1e-14 * gramian.norm()) break;
  }
  return gramian;
}

/// sd of e = (I - C (z I - A + L C)^-1 L) n for white n of sd r, by the impulse
/// response's energy.
VectorXd InnovationSd(const StateSpace& tick, const MatrixXd& L,
                      const VectorXd& noise_sd) {
  const MatrixXd gramian = StateByNoise(tick, L, noise_sd);
  const VectorXd fed_back = (tick.C * gramian * tick.C.transpose()).diagonal();
  return (noise_sd.cwiseAbs2() + fed_back).cwiseSqrt();
}

/// A tick with positions in multiples of the sensor noise, velocities the same a tick.
struct ScaledTick {
  MatrixXd A, C, Q;

  MatrixXd Spread(const MatrixXd& P) const {
    return C * P * C.transpose() + MatrixXd::Identity(C.rows(), C.rows());
  }
  MatrixXd Gain(const MatrixXd& P, const MatrixXd& S) const {
    return Solve(S, C * P * A.transpose()).transpose();
  }
};

class Scaling {
 public:
  Scaling(const StateSpace& tick, const VectorXd& noise_sd, Index nq)
      : state_(2 * nq), noise_(noise_sd) {
    const double unit = noise_sd.minCoeff();
    state_ << VectorXd::Constant(nq, unit),
        VectorXd::Constant(nq, unit / tick.sample_time);
  }

  ScaledTick Of(const StateSpace& tick, const VectorXd& force_sd) const {
    const MatrixXd B =
        state_.cwiseInverse().asDiagonal() * tick.B * force_sd.asDiagonal();
    return {state_.cwiseInverse().asDiagonal() * tick.A * state_.asDiagonal(),
            noise_.cwiseInverse().asDiagonal() * tick.C * state_.asDiagonal(),
            B * B.transpose()};
  }
  MatrixXd Covariance(const MatrixXd& P) const {
    return state_.asDiagonal() * P * state_.asDiagonal();
  }
  MatrixXd Gain(const MatrixXd& gain) const {
    return state_.asDiagonal() * gain * noise_.cwiseInverse().asDiagonal();
  }

 private:
  VectorXd state_;
  VectorXd noise_;
};

}  // namespace

Observer DesignObserver(const MechanicalModel& model, double step, int substeps,
                        const VectorXd& noise_sd, double bandwidth) {
  const double tick = step * substeps;
  if (!(noise_sd.minCoeff() > 0.0)) {
    throw InputError("observer", "a sensor without noise", "noise > 0 on every sensor");
  }
  if (!(bandwidth > 0.0) || !(bandwidth < 0.25 / tick)) {
    throw InputError("observer", "bandwidth " + std::to_string(bandwidth) + " Hz",
                     "above 0 and below a quarter of the control rate");
  }
  Observer observer;
  observer.tick = TickModel(model, step, substeps);
  observer.noise_sd = noise_sd;

  const Scaling scaling(observer.tick, noise_sd, model.M.rows());
  const ScaledTick scaled =
      scaling.Of(observer.tick, ForceNoise(model, noise_sd, bandwidth));
  const MatrixXd P = SolveRiccati(
      scaled.A, scaled.C, scaled.Q, 1e-14,
      "observer: no stable one exists; a motion that nothing holds is not seen by any "
      "sensor");
  const MatrixXd S = scaled.Spread(P);
  const MatrixXd gain = scaled.Gain(P, S);
  observer.bandwidth = bandwidth;
  observer.P = scaling.Covariance(P);
  observer.L = scaling.Gain(gain);
  const double radius = SpectralRadius(observer.tick.A - observer.L * observer.tick.C);
  if (!(radius < 1.0)) {
    throw NumericalError("observer: not stable, largest pole " +
                         std::to_string(radius));
  }
  observer.innovation_covariance = noise_sd.asDiagonal() * S * noise_sd.asDiagonal();
  observer.innovation_sd = InnovationSd(observer.tick, observer.L, noise_sd);
  return observer;
}

}  // namespace mjdiag
