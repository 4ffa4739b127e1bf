#include "mjdiag/plugin/replay/error_dynamics.h"

#include <cmath>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ErrorDynamics::ErrorDynamics(const Observer& observer, Index block)
    : block_(block),
      observer_(observer),
      C_(observer.innovation_sd.cwiseInverse().asDiagonal() * observer.tick.C),
      LC_(observer.L * observer.tick.C),
      weight_(observer.innovation_sd.cwiseInverse()) {}

// The state that what was leaves is none.
void ErrorDynamics::Begin() {
  if (in_open_ == 0 && blocks_.empty()) return;
  Block& last = in_open_ > 0 ? open_ : blocks_.back();
  last.F.setZero();
  last.B.setZero();
  last.L.setZero();
}

void ErrorDynamics::Add(const TickTangent& tick, const SampleMask& measured,
                        const SampleMask& counted) {
  const MatrixXd& L = observer_.L;
  if (measured.size() > 0 && !measured.all()) {
    const MatrixXd pull = L * measured.cast<double>().matrix().asDiagonal();
    Add(tick.A - pull * observer_.tick.C, tick.B, pull);
  } else {
    Add(tick.A - LC_, tick.B, L);
  }
  Miss(counted.size() > 0 ? counted : measured);
  if (++in_open_ < block_) return;
  blocks_.push_back(std::move(open_));
  in_open_ = 0;
}

void ErrorDynamics::Add(const MatrixXd& F, const MatrixXd& B, const MatrixXd& L) {
  if (in_open_ == 0) {
    open_ = {F, B, L};
  } else {
    open_.F = F * open_.F;
    open_.B = F * open_.B + B;
    open_.L = F * open_.L + L;
  }
}

void ErrorDynamics::Miss(const SampleMask& counted) {
  if (counted.size() == 0 || counted.all()) return;
  if (open_.seen.size() == 0) open_.seen = VectorXd::Ones(counted.size());
  open_.seen -= (1.0 - counted.cast<double>()).matrix() / static_cast<double>(block_);
}

// The mean over a block is that of its ends, x and next, whose sum it is applied to.
MatrixXd ErrorDynamics::SeenMean() const {
  return block_ == 1 ? C_ : MatrixXd(0.5 * std::sqrt(static_cast<double>(block_)) * C_);
}

template <typename Drive, typename Seen>
MatrixXd ErrorDynamics::Respond(Index blocks, Index signals, const Drive& drive,
                                const Seen& seen) const {
  const Index ny = C_.rows();
  const MatrixXd always = SeenMean();
  MatrixXd x = MatrixXd::Zero(C_.cols(), signals);
  MatrixXd next(x.rows(), x.cols());
  MatrixXd response(ny * blocks, signals);
  for (Index k = 0; k < blocks; ++k) {
    next.noalias() = blocks_[static_cast<std::size_t>(k)].F * x;
    drive(next, k);
    if (block_ > 1) x += next;
    auto now = response.middleRows(ny * k, ny);
    now.noalias() = always * x;
    seen(now, k);
    const VectorXd& share = blocks_[static_cast<std::size_t>(k)].seen;
    if (share.size() > 0) now.array().colwise() *= share.array();
    x.swap(next);
  }
  return response;
}

MatrixXd ErrorDynamics::OfForces(const MatrixXd& entry, const MatrixXd& forces) const {
  const MatrixXd mean =
      Averaged(forces, 1, block_).transpose() / std::sqrt(static_cast<double>(block_));
  const auto nothing = [](const auto&, Index) {};
  // Mostly all signals enter at one joint.
  if ((entry.colwise() - entry.col(0)).isZero(0.0)) {
    return Respond(
        mean.cols(), mean.rows(),
        [&](MatrixXd& next, Index k) {
          const VectorXd unit = blocks_[static_cast<std::size_t>(k)].B * entry.col(0);
          next.noalias() += unit * mean.col(k).transpose();
        },
        nothing);
  }
  return Respond(
      mean.cols(), mean.rows(),
      [&](MatrixXd& next, Index k) {
        next.noalias() +=
            blocks_[static_cast<std::size_t>(k)].B * (entry * mean.col(k).asDiagonal());
      },
      nothing);
}

MatrixXd ErrorDynamics::OfReadings(Index sensor, const MatrixXd& errors) const {
  const double root = std::sqrt(static_cast<double>(block_));
  const MatrixXd mean = Averaged(errors, 1, block_).transpose() / root;
  return Respond(
      mean.cols(), mean.rows(),
      [&](MatrixXd& next, Index k) {
        next.noalias() -= blocks_[static_cast<std::size_t>(k)].L.col(sensor) *
                          mean.col(k).transpose();
      },
      [&](auto& now, Index k) {
        now.row(sensor) += root * weight_[sensor] * mean.col(k).transpose();
      });
}

// Backwards in time. With a block's response S (x[k] + x[k+1]) (S x[k] for blocks of
// one) the multiplier of x[k+1] is l[k] = F^T l[k+1] + S^T (e[k] + e[k+1]).
ErrorDynamics::Adjoint ErrorDynamics::AdjointOf(const VectorXd& innovations) const {
  const Index ny = C_.rows();
  const Index blocks = innovations.size() / ny;
  MatrixXd e = Eigen::Map<const MatrixXd>(innovations.data(), ny, blocks);
  for (Index k = 0; k < blocks; ++k) {
    const VectorXd& share = blocks_[static_cast<std::size_t>(k)].seen;
    if (share.size() > 0) e.col(k) = share.cwiseProduct(e.col(k)).eval();
  }
  const double root = std::sqrt(static_cast<double>(block_));
  const MatrixXd always = SeenMean();
  Adjoint adjoint{MatrixXd(blocks, C_.cols() / 2), MatrixXd(blocks, ny)};
  VectorXd multiplier = VectorXd::Zero(C_.cols());
  VectorXd later = VectorXd::Zero(ny);
  for (Index k = blocks - 1; k >= 0; --k) {
    // Of x[k+1]: through the next block's dynamics and both responses it is in.
    if (k + 1 < blocks) {
      multiplier = blocks_[static_cast<std::size_t>(k + 1)].F.transpose() * multiplier;
    }
    const Block& block = blocks_[static_cast<std::size_t>(k)];
    multiplier +=
        always.transpose() * (block_ > 1 ? VectorXd(e.col(k) + later) : later);
    adjoint.forces.row(k) = (block.B.transpose() * multiplier).transpose();
    adjoint.readings.row(k) =
        (root * weight_.cwiseProduct(e.col(k)) - block.L.transpose() * multiplier)
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
