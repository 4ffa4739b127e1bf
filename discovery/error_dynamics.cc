#include "mjdiag/discovery/error_dynamics.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <map>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Tick {
  MatrixXd A;
  MatrixXd B;
};

/// The tick of TickModel with forces on every joint as inputs, while joints stick.
Tick StickingTick(const MechanicalModel& model, double h, int substeps,
                  const VectorXd& free) {
  const Index n = model.M.rows();
  // A stuck joint: a row and column of the identity, and no force.
  MatrixXd inertia = free.asDiagonal() * (model.M + h * model.D) * free.asDiagonal();
  inertia.diagonal() += VectorXd::Ones(n) - free;
  const Eigen::LDLT<MatrixXd> solver(inertia);
  const MatrixXd accelerate = solver.solve(MatrixXd(free.asDiagonal()));
  const MatrixXd keep = free.asDiagonal();
  const MatrixXd v_of_v = keep - h * accelerate * model.D * keep;
  const MatrixXd v_of_q = -h * accelerate * model.K;
  const MatrixXd v_of_f = h * accelerate;
  MatrixXd A(2 * n, 2 * n);
  A << MatrixXd::Identity(n, n) + h * v_of_q, h * v_of_v, v_of_q, v_of_v;
  MatrixXd B(2 * n, n);
  B << h * v_of_f, v_of_f;
  Tick tick{MatrixXd::Identity(2 * n, 2 * n), MatrixXd::Zero(2 * n, n)};
  for (int i = 0; i < substeps; ++i) {
    tick.A = A * tick.A;
    tick.B = A * tick.B + B;
  }
  return tick;
}

}  // namespace

ErrorDynamics::ErrorDynamics(const MechanicalModel& model, const Observer& observer,
                             double step, int substeps, const Sticking& sticking,
                             Index block)
    : block_(block),
      C_(observer.innovation_sd.cwiseInverse().asDiagonal() * observer.tick.C),
      weight_(observer.innovation_sd.cwiseInverse()) {
  std::map<std::vector<unsigned char>, std::size_t> known;
  for (Index k = 0; k < sticking.cols(); k += block) {
    const std::vector<unsigned char> stuck(sticking.col(k).begin(),
                                           sticking.col(k).end());
    const auto [entry, is_new] = known.emplace(stuck, modes_.size());
    if (is_new) {
      const VectorXd free =
          VectorXd::Ones(sticking.rows()) - sticking.col(k).cast<double>();
      const Tick tick = StickingTick(model, step, substeps, free);
      const MatrixXd F = tick.A - observer.L * observer.tick.C;
      Mode mode{F, tick.B, observer.L};
      for (Index i = 1; i < block; ++i) {
        mode.B = F * mode.B + tick.B;
        mode.L = F * mode.L + observer.L;
        mode.F = F * mode.F;
      }
      modes_.push_back(mode);
    }
    mode_of_.push_back(entry->second);
  }
}

// The mean over a block is that of its ends, x and next, whose sum it is applied to.
MatrixXd ErrorDynamics::SeenMean() const {
  return block_ == 1 ? C_ : MatrixXd(0.5 * std::sqrt(static_cast<double>(block_)) * C_);
}

MatrixXd ErrorDynamics::OfForces(const MatrixXd& entry, const MatrixXd& forces) const {
  std::vector<MatrixXd> drive;
  for (const Mode& mode : modes_) drive.push_back(mode.B * entry);
  const MatrixXd mean =
      Averaged(forces, 1, block_).transpose() / std::sqrt(static_cast<double>(block_));
  const Index ny = C_.rows();
  MatrixXd x = MatrixXd::Zero(C_.cols(), mean.rows());
  MatrixXd next(x.rows(), x.cols());
  MatrixXd response(ny * mean.cols(), x.cols());
  const MatrixXd seen = SeenMean();
  for (Index k = 0; k < mean.cols(); ++k) {
    next.noalias() = At(k).F * x;
    next += drive[mode_of_[static_cast<std::size_t>(k)]] * mean.col(k).asDiagonal();
    if (block_ > 1) x += next;
    response.middleRows(ny * k, ny).noalias() = seen * x;
    x.swap(next);
  }
  return response;
}

MatrixXd ErrorDynamics::OfReadings(Index sensor, const MatrixXd& errors) const {
  const double root = std::sqrt(static_cast<double>(block_));
  const MatrixXd mean = Averaged(errors, 1, block_).transpose() / root;
  const Index ny = C_.rows();
  MatrixXd x = MatrixXd::Zero(C_.cols(), mean.rows());
  MatrixXd next(x.rows(), x.cols());
  MatrixXd response(ny * mean.cols(), x.cols());
  const MatrixXd seen = SeenMean();
  for (Index k = 0; k < mean.cols(); ++k) {
    next.noalias() = At(k).F * x;
    next.noalias() -= At(k).L.col(sensor) * mean.col(k).transpose();
    auto now = response.middleRows(ny * k, ny);
    if (block_ > 1) x += next;
    now.noalias() = seen * x;
    now.row(sensor) += root * weight_[sensor] * mean.col(k).transpose();
    x.swap(next);
  }
  return response;
}

// Backwards in time. With a block's response S (x[k] + x[k+1]) (S x[k] for blocks of
// one) the multiplier of x[k+1] is l[k] = F^T l[k+1] + S^T (e[k] + e[k+1]).
ErrorDynamics::Adjoint ErrorDynamics::AdjointOf(const VectorXd& innovations) const {
  const Index ny = C_.rows();
  const Index blocks = innovations.size() / ny;
  const Eigen::Map<const MatrixXd> e(innovations.data(), ny, blocks);
  const double root = std::sqrt(static_cast<double>(block_));
  const MatrixXd seen = SeenMean();
  Adjoint adjoint{MatrixXd(blocks, C_.cols() / 2), MatrixXd(blocks, ny)};
  VectorXd multiplier = VectorXd::Zero(C_.cols());
  VectorXd later = VectorXd::Zero(ny);
  for (Index k = blocks - 1; k >= 0; --k) {
    // Of x[k+1]: through the next block's dynamics and both responses it is in.
    if (k + 1 < blocks) multiplier = At(k + 1).F.transpose() * multiplier;
    multiplier += seen.transpose() * (block_ > 1 ? VectorXd(e.col(k) + later) : later);
    adjoint.forces.row(k) = (At(k).B.transpose() * multiplier).transpose();
    adjoint.readings.row(k) =
        (root * weight_.cwiseProduct(e.col(k)) - At(k).L.transpose() * multiplier)
            .transpose();
    later = e.col(k);
  }
  return adjoint;
}

MatrixXd Averaged(const MatrixXd& stacked, Index channels, Index block) {
  const Index blocks = stacked.rows() / channels / block;
  if (block == 1) return stacked;
  const double scale = 1.0 / std::sqrt(static_cast<double>(block));
  MatrixXd averaged(channels * blocks, stacked.cols());
  for (Index c = 0; c < stacked.cols(); ++c) {
    for (Index k = 0; k < blocks; ++k) {
      for (Index i = 0; i < channels; ++i) {
        double sum = 0.0;
        for (Index j = 0; j < block; ++j) {
          sum += stacked(channels * (block * k + j) + i, c);
        }
        averaged(channels * k + i, c) = scale * sum;
      }
    }
  }
  return averaged;
}

}  // namespace mjdiag
