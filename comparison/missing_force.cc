#include "mjdiag/comparison/missing_force.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/replay/motion_path.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPower = 3.0;
constexpr double kFastest = 32.0;  // times the bandwidth of the motion
// Of the state and of the forces before the first sample, in multiples of what they are
// known to later: anything.
constexpr double kFree = 1e3;

/// Tick models with forces at joints for states [xt; f] in units of the noise.
class ForcedPath {
 public:
  ForcedPath(const Machine& machine, const MeasuredRun& run, const Observer& observer,
             const MatrixXd& innovations, const std::vector<Index>& dofs)
      : run_(run), path_(*observer.following->path) {
    const auto forces = static_cast<Index>(dofs.size());
    const VectorXd& noise = observer.noise_sd;
    const double unit = noise.minCoeff();
    const Index nq = machine.plant().nv;
    states_ = 2 * nq;
    scale_.resize(states_);
    scale_ << VectorXd::Constant(nq, unit),
        VectorXd::Constant(nq, unit / run.sample_time);
    e_ = noise.cwiseInverse().asDiagonal() * innovations;
    VectorXd light = VectorXd::Zero(forces);
    std::vector<StateSpace> ticks;
    for (const MotionPath::Stretch& stretch : path_.stretches) {
      MechanicalModel forced = stretch.model;
      forced.Gamma = MatrixXd::Zero(nq, forces);
      for (Index j = 0; j < forces; ++j) {
        forced.Gamma(dofs[static_cast<std::size_t>(j)], j) = 1.0;
      }
      const MatrixXd moves = noise.cwiseInverse().asDiagonal() * forced.b.transpose() *
                             Solve(forced.M, forced.Gamma);
      light += moves.cwiseAbs().colwise().maxCoeff().transpose();
      ticks.push_back(
          TickModel(forced, machine.plant().opt.timestep, machine.rates().substeps));
    }
    light *= run.sample_time * run.sample_time / static_cast<double>(ticks.size());
    unit_ = (light.array() > 0.0).select(light.cwiseInverse(), 0.0);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      MatrixXd A = MatrixXd::Identity(states_ + forces, states_ + forces);
      A.topLeftCorner(states_, states_) =
          scale_.cwiseInverse().asDiagonal() * ticks[i].A * scale_.asDiagonal();
      A.topRightCorner(states_, forces) =
          scale_.cwiseInverse().asDiagonal() * ticks[i].B * unit_.asDiagonal();
      MatrixXd C = MatrixXd::Zero(noise.size(), states_ + forces);
      C.leftCols(states_) =
          noise.cwiseInverse().asDiagonal() * ticks[i].C * scale_.asDiagonal();
      MatrixXd L = MatrixXd::Zero(states_ + forces, noise.size());
      L.topRows(states_) = scale_.cwiseInverse().asDiagonal() *
                           observer.following->L[i] * noise.asDiagonal();
      A_.push_back(std::move(A));
      C_.push_back(std::move(C));
      L_.push_back(std::move(L));
    }
  }

  Index states() const { return states_; }
  Index forces() const { return unit_.size(); }
  Index samples() const { return e_.cols(); }
  const VectorXd& unit() const { return unit_; }
  std::size_t StretchOf(Index k) const {
    return path_.of_sample[static_cast<std::size_t>(k)];
  }
  Index FirstOf(std::size_t stretch) const { return path_.stretches[stretch].first; }
  std::size_t stretches() const { return path_.stretches.size(); }
  const MatrixXd& A(std::size_t stretch) const { return A_[stretch]; }
  const MatrixXd& L(std::size_t stretch) const { return L_[stretch]; }
  /// Without what was not measured.
  MatrixXd C(Index k) const {
    MatrixXd C = C_[StretchOf(k)];
    if (run_.Counted().size() > 0) {
      C = run_.Counted().col(k).cast<double>().matrix().asDiagonal() * C;
    }
    return C;
  }
  /// How many readings count.
  double Values(Index k) const {
    if (run_.Counted().size() == 0) return static_cast<double>(e_.rows());
    return static_cast<double>(run_.Counted().col(k).count());
  }
  auto e(Index k) const { return e_.col(k); }
  /// Whether nothing is known of the state: at the start of a record, and where readings
  /// have pulled the observer that do not count.
  bool IsFree(Index k) const {
    if (std::ranges::any_of(run_.records, [k](const RecordStart& record) {
          return record.sample == k;
        })) {
      return true;
    }
    if (k == 0 || run_.counted.size() == 0) return false;
    const auto measured = [&](Index sensor) {
      return run_.measured.size() == 0 || run_.measured(sensor, k - 1);
    };
    for (Index i = 0; i < e_.rows(); ++i) {
      if (measured(i) && !run_.counted(i, k - 1)) return true;
    }
    return false;
  }

 private:
  const MeasuredRun& run_;
  const MotionPath& path_;
  Index states_ = 0;
  VectorXd scale_;
  VectorXd unit_;  // z0
  MatrixXd e_;
  std::vector<MatrixXd> A_, C_, L_;  // of every stretch
};

/// The filter from one tick to the next.
class Filter {
 public:
  /// @param bandwidth  b of every force
  Filter(const ForcedPath& path, const VectorXd& bandwidth)
      : path_(path), walk_(bandwidth.array().pow(kPower)), bandwidth_(bandwidth) {}

  /// Before its next sample.
  struct State {
    VectorXd x;
    MatrixXd P;
  };
  /// What the way back needs of a sample.
  struct Step {
    VectorXd x;
    MatrixXd P_forces;
    MatrixXd F;
    MatrixXd C;
    VectorXd pull;      // C^T S^-1 nu
    MatrixXd to_state;  // C^T S^-1
  };

  State Free() const {
    const Index n = path_.states() + path_.forces();
    VectorXd sd(n);
    sd << VectorXd::Constant(path_.states(), kFree),
        kFree * walk_.cwiseQuotient(bandwidth_.cwiseSqrt());
    return {VectorXd::Zero(n), sd.cwiseAbs2().asDiagonal()};
  }

  /// nu^T S^-1 nu and ln det S of a sample.
  struct Misfit {
    double square = 0.0;
    double log_det = 0.0;
  };

  /// Adds sample k.
  Misfit Advance(Index k, State& state, Step* step) const {
    if (path_.IsFree(k)) state = Free();
    const std::size_t stretch = path_.StretchOf(k);
    const MatrixXd& A = path_.A(stretch);
    const MatrixXd C = path_.C(k);
    const MatrixXd PC = state.P * C.transpose();
    const Eigen::LLT<MatrixXd> S(C * PC + MatrixXd::Identity(C.rows(), C.rows()));
    const VectorXd nu = path_.e(k) - C * state.x;
    const VectorXd weighed = S.solve(nu);
    const MatrixXd gain = S.solve(PC.transpose()).transpose();
    if (step != nullptr) {
      step->x = state.x;
      step->P_forces = state.P.bottomRows(path_.forces());
      step->C = C;
      step->to_state = S.solve(C).transpose();
      step->pull = C.transpose() * weighed;
      step->F = A - A * gain * C;
    }
    state.x = A * (state.x + gain * nu) - path_.L(stretch) * path_.e(k);
    const MatrixXd updated = state.P - gain * PC.transpose();
    state.P = A * updated * A.transpose();
    state.P.diagonal().tail(path_.forces()) += walk_.cwiseAbs2();
    state.P = 0.5 * (state.P + state.P.transpose()).eval();
    return {nu.dot(weighed), 2.0 * S.matrixLLT().diagonal().array().log().sum()};
  }

 private:
  const ForcedPath& path_;
  VectorXd walk_;
  VectorXd bandwidth_;
};

/// By E. B. Wilson and M. M. Hilferty, Proc. National Academy of Sciences 17, 1931.
double MedianOfChiSquared(double freedom) {
  return freedom * std::pow(1.0 - 2.0 / (9.0 * freedom), 3.0);
}

struct Likelihood {
  double deviance = std::numeric_limits<double>::infinity();  ///< -2 ln L
  double noise = 1.0;                                         ///< c
};

/// Of the middle of the run.
Likelihood LikelihoodOf(const ForcedPath& path, const VectorXd& bandwidth) {
  constexpr Index kSamples = 4000;
  constexpr Index kSettling = 200;
  const Index count = std::min(kSamples, path.samples());
  const Index first = (path.samples() - count) / 2;
  const Filter filter(path, bandwidth);
  Filter::State state = filter.Free();
  std::vector<double> squares;  // over what is expected of their median
  double log_det = 0.0;
  double values = 0.0;
  for (Index k = first; k < first + count; ++k) {
    const Filter::Misfit one = filter.Advance(k, state, nullptr);
    if (k < first + std::min(kSettling, count / 4)) continue;
    const double readings = path.Values(k);
    if (readings == 0.0) continue;
    squares.push_back(one.square / MedianOfChiSquared(readings));
    log_det += one.log_det;
    values += readings;
  }
  if (squares.empty()) return {};
  const auto middle = squares.begin() + std::ssize(squares) / 2;
  std::nth_element(squares.begin(), middle, squares.end());
  const double deviance = values * std::log(*middle) + log_det;
  if (!std::isfinite(deviance)) return {};
  return {deviance, std::sqrt(*middle)};
}

/// Of those to try that with the least deviance.
VectorXd Likeliest(const ForcedPath& path, const std::vector<VectorXd>& tried) {
  std::vector<double> deviance(tried.size());
  ParallelFor(static_cast<int>(tried.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    deviance[i] = LikelihoodOf(path, tried[i]).deviance;
  });
  const auto best = std::ranges::min_element(deviance);
  return tried[static_cast<std::size_t>(best - deviance.begin())];
}

/// Changes of every row in a tick, over 20 ms to each side.
MatrixXd ChangesOf(const MatrixXd& rows, double tick) {
  constexpr double kSide = 0.02;  // [s]
  const auto side = std::max<Index>(2, static_cast<Index>(std::lround(kSide / tick)));
  MatrixXd changes(rows.rows(), rows.cols());
  for (Index k = 0; k < rows.cols(); ++k) {
    const Index first = std::max<Index>(0, k - side);
    const Index last = std::min(rows.cols() - 1, k + side);
    changes.col(k) = (rows.col(last) - rows.col(first)) /
                     static_cast<double>(std::max<Index>(1, last - first));
  }
  return changes;
}

/// [rad a tick] Of the fastest reading, by its rms acceleration over its rms velocity.
double MotionBandwidth(const MeasuredRun& run) {
  const MatrixXd velocity = ChangesOf(run.outputs, run.sample_time);
  const MatrixXd acceleration = ChangesOf(velocity, run.sample_time);
  return (acceleration.rowwise().norm().array() /
          velocity.rowwise().norm().array().max(1e-300))
      .maxCoeff();
}

VectorXd FindBandwidth(const ForcedPath& path, double motion) {
  const double fastest = std::min(1.0, kFastest * motion);
  const double slowest =
      std::min(fastest, 6.0 * std::numbers::pi / static_cast<double>(path.samples()));
  std::vector<VectorXd> together;
  for (double b = slowest; b <= fastest; b *= 2.0) {
    together.push_back(VectorXd::Constant(path.forces(), b));
  }
  VectorXd best = Likeliest(path, together);
  for (Index j = 0; j < path.forces(); ++j) {
    std::vector<VectorXd> alone;
    for (const double factor : {1.0, 0.25, 0.5, 2.0, 4.0}) {
      alone.push_back(best);
      alone.back()[j] = std::clamp(best[j] * factor, slowest, fastest);
    }
    best = Likeliest(path, alone);
  }
  return best;
}

struct Smoothed {
  MatrixXd value;     ///< forces x samples, in z0
  VectorXd variance;  ///< mean of the samples at which a stretch begins
};

/// Forwards once, keeping where every stretch begins; backwards stretch by stretch.
Smoothed Smooth(const ForcedPath& path, const VectorXd& bandwidth) {
  const Filter filter(path, bandwidth);
  std::vector<Filter::State> begins(path.stretches());
  Filter::State state = filter.Free();
  for (Index k = 0; k < path.samples(); ++k) {
    const std::size_t stretch = path.StretchOf(k);
    if (path.FirstOf(stretch) == k) begins[stretch] = state;
    filter.Advance(k, state, nullptr);
  }
  const Index n = state.x.size();
  Smoothed smoothed{MatrixXd(path.forces(), path.samples()),
                    VectorXd::Zero(path.forces())};
  VectorXd r = VectorXd::Zero(n);
  MatrixXd W = MatrixXd::Zero(n, n);
  std::vector<Filter::Step> steps;
  Index end = path.samples();
  for (std::size_t stretch = path.stretches(); stretch-- > 0;) {
    const Index first = path.FirstOf(stretch);
    steps.resize(static_cast<std::size_t>(end - first));
    state = begins[stretch];
    for (Index k = first; k < end; ++k) {
      filter.Advance(k, state, &steps[static_cast<std::size_t>(k - first)]);
    }
    for (Index k = end; k-- > first;) {
      const Filter::Step& step = steps[static_cast<std::size_t>(k - first)];
      r = step.pull + step.F.transpose() * r;
      W = step.to_state * step.C + step.F.transpose() * W * step.F;
      smoothed.value.col(k) = step.x.tail(path.forces()) + step.P_forces * r;
      if (k == first) {
        const MatrixXd& P = step.P_forces;
        smoothed.variance +=
            P.rightCols(path.forces()).diagonal() - (P * W * P.transpose()).diagonal();
      }
      // What comes is not what was.
      if (path.IsFree(k)) {
        r.setZero();
        W.setZero();
      }
    }
    end = first;
  }
  smoothed.variance /= static_cast<double>(path.stretches());
  return smoothed;
}

}  // namespace

std::vector<Index> ForcedDofs(const Machine& machine) {
  const MechanicalModel& model = machine.linear();
  const Index sensors = model.b.cols();
  std::vector<Index> dofs;
  for (Index dof = 0; dof < model.M.rows() && std::ssize(dofs) < sensors; ++dof) {
    const bool driven = !model.Gamma.row(dof).isZero(0.0);
    if (driven || sensors >= model.M.rows()) dofs.push_back(dof);
  }
  return dofs;
}

double FastestForce(const MeasuredRun& run) {
  return kFastest * MotionBandwidth(run) / (2.0 * std::numbers::pi * run.sample_time);
}

std::vector<MissingForce> MissingForces(const Machine& machine, const MeasuredRun& run,
                                        const Observer& observer,
                                        const MatrixXd& innovations) {
  if (!observer.following) {
    throw InputError("missing forces", "an observer that stays at rest",
                     "one that follows the motion");
  }
  const std::vector<Index> dofs = ForcedDofs(machine);
  if (dofs.empty()) return {};
  const ForcedPath path(machine, run, observer, innovations, dofs);
  const VectorXd bandwidth = FindBandwidth(path, MotionBandwidth(run));
  const Smoothed smoothed = Smooth(path, bandwidth);
  const double noise = LikelihoodOf(path, bandwidth).noise;
  const mjModel& plant = machine.plant();
  std::vector<MissingForce> forces;
  for (std::size_t j = 0; j < dofs.size(); ++j) {
    const auto row = static_cast<Index>(j);
    const int joint = plant.dof_jntid[dofs[j]];
    MissingForce force;
    force.joint = ElementName(plant, mjOBJ_JOINT, joint);
    force.unit = plant.jnt_type[joint] == mjJNT_HINGE ? "N m" : "N";
    force.value = path.unit()[row] * smoothed.value.row(row).transpose();
    force.rms = Rms(force.value);
    force.sd =
        noise * path.unit()[row] * std::sqrt(std::max(0.0, smoothed.variance[row]));
    force.bandwidth = bandwidth[row] / (2.0 * std::numbers::pi * run.sample_time);
    forces.push_back(std::move(force));
  }
  return forces;
}

}  // namespace mjdiag
