#include "mjdiag/plugin/replay/observer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/motion_path.h"
#include "mjdiag/plugin/replay/riccati.h"
#include "mjdiag/plugin/replay/tracking.h"
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

namespace {

/// Gains of every stretch of a record from stretch `first` to `last`, and what they make
/// of the noise.
class RecordGain {
 public:
  RecordGain(const MotionPath& path, const VectorXd& noise_sd, double bandwidth)
      : path_(path),
        noise_sd_(noise_sd),
        bandwidth_(bandwidth),
        scaling_(path.stretches.front().tick, noise_sd,
                 path.stretches.front().model.M.rows()) {}

  /// @param ends  the sample behind each stretch
  void Design(std::size_t first, std::size_t last, const std::vector<Index>& ends,
              std::vector<MatrixXd>& L) {
    MatrixXd P;
    for (std::size_t i = first; i < last; ++i) {
      const MotionPath::Stretch& stretch = path_.stretches[i];
      const ScaledTick tick =
          scaling_.Of(stretch.tick, ForceNoise(stretch.model, noise_sd_, bandwidth_));
      if (i == first) {
        P = SolveRiccati(tick.A, tick.C, tick.Q, 1e-14,
                         "observer: no stable one exists where a record begins; a "
                         "motion that nothing holds is not seen by any sensor");
        if (i == 0) start = scaling_.Covariance(P);
      }
      const Index ticks = ends[i] - stretch.first;
      for (Index k = 0; k < ticks; ++k) {
        const MatrixXd S = tick.Spread(P);
        const MatrixXd gain = tick.Gain(P, S);
        if (k == ticks / 2) L[i] = scaling_.Gain(gain);
        spread += S;
        P = tick.A * P * tick.A.transpose() + tick.Q - gain * S * gain.transpose();
        P = 0.5 * (P + P.transpose()).eval();
      }
      ticks_ += ticks;
      if (!P.allFinite()) {
        throw NumericalError("observer: no stable one exists along the motion");
      }
    }
  }

  MatrixXd Spread() const {
    return noise_sd_.asDiagonal() * (spread / static_cast<double>(ticks_)) *
           noise_sd_.asDiagonal();
  }

  MatrixXd start;                          // P of the first sample of all
  MatrixXd spread = MatrixXd::Zero(0, 0);  // sum of S, scaled

 private:
  const MotionPath& path_;
  VectorXd noise_sd_;
  double bandwidth_;
  Scaling scaling_;
  Index ticks_ = 0;
};

/// Covariance of the state by sensor noise alone, from one tick of a motion to the next.
struct MovingCovariance {
  const Observer& observer;
  MatrixXd S;

  explicit MovingCovariance(const Observer& of)
      : observer(of), S(MatrixXd::Zero(of.tick.A.rows(), of.tick.A.rows())) {}

  MatrixXd F(Index sample) const {
    const MotionPath& path = *observer.following->path;
    const std::size_t i = path.of_sample[static_cast<std::size_t>(sample)];
    return path.stretches[i].tick.A -
           observer.following->L[i] * path.stretches[i].tick.C;
  }
  void Advance(Index sample) {
    const MatrixXd now = F(sample);
    const MatrixXd noise = observer.GainAt(sample) * observer.noise_sd.asDiagonal();
    S = now * S * now.transpose() + noise * noise.transpose();
  }
};

VectorXd FollowingInnovationSd(const Observer& observer) {
  const auto samples = static_cast<Index>(observer.following->path->of_sample.size());
  // Until then the covariance, which begins at 0, grows.
  const Index settled = samples / 10;
  MovingCovariance state(observer);
  VectorXd fed_back = VectorXd::Zero(observer.noise_sd.size());
  for (Index k = 0; k < samples; ++k) {
    const MatrixXd& C = observer.OutputsAt(k);
    if (k >= settled) fed_back += (C * state.S * C.transpose()).diagonal();
    state.Advance(k);
  }
  fed_back /= static_cast<double>(samples - settled);
  return (observer.noise_sd.cwiseAbs2() + fed_back).cwiseSqrt();
}

void FollowMotion(std::shared_ptr<const MotionPath> path, Observer& observer) {
  const std::size_t stretches = path->stretches.size();
  std::vector<Index> ends(stretches);
  for (std::size_t i = 0; i < stretches; ++i) {
    ends[i] = i + 1 < stretches ? path->stretches[i + 1].first
                                : static_cast<Index>(path->of_sample.size());
  }
  auto gain = std::make_shared<FollowingGain>();
  gain->L.resize(stretches);
  RecordGain design(*path, observer.noise_sd, observer.bandwidth);
  design.spread.setZero(observer.noise_sd.size(), observer.noise_sd.size());
  for (std::size_t r = 0; r < path->first_stretches.size(); ++r) {
    const bool is_last = r + 1 == path->first_stretches.size();
    design.Design(path->first_stretches[r],
                  is_last ? stretches : path->first_stretches[r + 1], ends, gain->L);
  }
  gain->path = std::move(path);
  observer.L = gain->L.front();
  observer.P = design.start;
  observer.innovation_covariance = design.Spread();
  observer.following = std::move(gain);
  observer.innovation_sd = FollowingInnovationSd(observer);
}

/// Means over starts all along the motion.
VectorXd FollowingNoiseCorrelation(const Observer& observer, Index sensor, Index lags) {
  constexpr Index kStarts = 100;
  const auto samples = static_cast<Index>(observer.following->path->of_sample.size());
  const Index every = std::max<Index>(1, samples / kStarts);
  const double r = observer.noise_sd[sensor];
  MovingCovariance state(observer);
  VectorXd shared = VectorXd::Zero(lags);
  double own = 0.0;
  for (Index k = 0; k + lags < samples; ++k) {
    if (k % every == every - 1) {
      const VectorXd seen = observer.OutputsAt(k).row(sensor).transpose();
      own += seen.dot(state.S * seen) + r * r;
      VectorXd next =
          state.F(k) * state.S * seen - r * r * observer.GainAt(k).col(sensor);
      for (Index l = 0; l < lags; ++l) {
        shared[l] += observer.OutputsAt(k + l + 1).row(sensor).dot(next);
        next = state.F(k + l + 1) * next;
      }
    }
    state.Advance(k);
  }
  return shared / own;
}

}  // namespace

const MatrixXd& Observer::GainAt(Index sample) const {
  if (!following) return L;
  return following->L[following->path->of_sample[static_cast<std::size_t>(sample)]];
}

const MatrixXd& Observer::OutputsAt(Index sample) const {
  if (!following) return tick.C;
  const MotionPath& path = *following->path;
  return path.stretches[path.of_sample[static_cast<std::size_t>(sample)]].tick.C;
}

Observer DesignObserver(const Machine& machine, const MeasuredRun& run,
                        const VectorXd& noise_sd, double bandwidth,
                        std::shared_ptr<const MotionPath> path) {
  Observer observer = DesignObserver(machine.linear(), machine.plant().opt.timestep,
                                     machine.rates().substeps, noise_sd, bandwidth);
  if (!path && !RestGainHolds(machine, run, bandwidth)) path = PathAlong(machine, run);
  if (path) FollowMotion(std::move(path), observer);
  return observer;
}

Observer OnRun(const Observer& observer, const Machine& machine,
               const MeasuredRun& run) {
  if (!observer.following && RestGainHolds(machine, run, observer.bandwidth)) {
    return observer;
  }
  Observer other = DesignObserver(machine, run, observer.noise_sd, observer.bandwidth);
  ScaleGain(observer.gain_factors, other);
  // What is compared is weighed alike.
  other.innovation_sd = observer.innovation_sd;
  other.innovation_covariance = observer.innovation_covariance;
  return other;
}

void ScaleGain(const VectorXd& factors, Observer& observer) {
  if (factors.size() == 0) return;
  observer.gain_factors = factors;
  observer.L = observer.L * factors.asDiagonal();
  for (Index i = 0; i < factors.size(); ++i) {
    if (factors[i] == 1.0) continue;
    const double r = observer.noise_sd[i];
    const double fed_back =
        observer.innovation_sd[i] * observer.innovation_sd[i] - r * r;
    observer.innovation_sd[i] = std::sqrt(r * r + factors[i] * std::max(0.0, fed_back));
  }
  if (!observer.following) return;
  auto gain = std::make_shared<FollowingGain>(*observer.following);
  for (MatrixXd& L : gain->L) L = L * factors.asDiagonal();
  observer.following = std::move(gain);
}

VectorXd NoiseCorrelation(const Observer& observer, Index sensor, Index lags) {
  if (observer.following) return FollowingNoiseCorrelation(observer, sensor, lags);
  const MatrixXd& C = observer.tick.C;
  const MatrixXd F = observer.tick.A - observer.L * C;
  const MatrixXd S = StateByNoise(observer.tick, observer.L, observer.noise_sd);
  const double r = observer.noise_sd[sensor];
  const VectorXd seen = C.row(sensor).transpose();
  VectorXd next = F * S * seen - r * r * observer.L.col(sensor);
  VectorXd correlation(lags);
  for (Index l = 0; l < lags; ++l) {
    correlation[l] = seen.dot(next);
    next = F * next;
  }
  const VectorXd spread = S * seen;
  return correlation / (seen.dot(spread) + r * r);
}

}  // namespace mjdiag
