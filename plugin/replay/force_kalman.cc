#include "mjdiag/plugin/replay/force_kalman.h"

#include <algorithm>
#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of the variances in a tick: a filter that remembers a thousand ticks is then within a
// thousandth of its end.
constexpr double kAtItsEnd = 1e-6;

/// Columns of some degrees of freedom, and a last one of zeros for the clock.
MatrixXd ForcesOf(const MatrixXd& all, const std::vector<Index>& dofs) {
  const auto nf = static_cast<Index>(dofs.size());
  MatrixXd forces = MatrixXd::Zero(all.rows(), nf + 1);
  forces.leftCols(nf) = all(Eigen::indexing::all, dofs);
  return forces;
}

VectorXd With(const VectorXd& forces, double clock) {
  VectorXd all(forces.size() + 1);
  all << forces, clock;
  return all;
}

}  // namespace

ForceKalman::ForceKalman(const std::vector<Index>& dofs, const FilterNoise& noise,
                         double sample_time)
    : dofs_(dofs), noise_(noise) {
  const VectorXd decay =
      sample_time * With(noise.memory, noise.clock_memory).cwiseInverse();
  rho_ = (-decay.array()).exp();
  variance_ = With(noise.size, noise.clock).cwiseAbs2();
  white_ = noise.WhiteVariance(sample_time);
  // 1 - rho^2 without cancellation where the memory is long.
  renewal_ = -(-2.0 * decay.array()).expm1() * variance_.array();
}

void ForceKalman::Start(const VectorXd& sd) {
  const Index n = sd.size() + rho_.size();
  z = VectorXd::Zero(n);
  P = MatrixXd::Zero(n, n);
  P.diagonal() << sd.cwiseAbs2(), variance_;
  c_.resize(n);
  gains_ = MatrixXd::Zero(n, noise_.reading.size());
  variances_ = VectorXd::Zero(noise_.reading.size());
  taken_.clear();
  taken_before_.clear();
  before_ = P.diagonal();
  steady_ = false;
  moved_ = true;
}

void ForceKalman::MoveTo(const TickTangent& tangent) {
  if (tangent_ == &tangent) return;
  Unsettle();
  tangent_ = &tangent;
  B_ = ForcesOf(tangent.B, dofs_);
  D_ = ForcesOf(tangent.D, dofs_);
  const auto forces = B_.leftCols(white_.size());
  Q_.noalias() = forces * white_.asDiagonal() * forces.transpose();
}

void ForceKalman::Expect(Index sensor, bool late, double innovation, double speed) {
  const Index nf = rho_.size();
  const Index ns = z.size() - nf;
  c_.head(ns) = tangent_->C.row(sensor).transpose();
  double R = noise_.reading[sensor] * noise_.reading[sensor];
  if (late) {
    c_.tail(nf) = D_.row(sensor).transpose();
    R += D_.row(sensor).head(white_.size()).cwiseAbs2().dot(white_.transpose());
  } else {
    c_.tail(nf).setZero();
  }
  // A clock that is off by nothing that shows is left out, and the gains stay.
  constexpr double kShows = 1e-3;  // of its variance
  const bool clock_shows = std::pow(noise_.clock * speed, 2) >
                           kShows * noise_.reading[sensor] * noise_.reading[sensor];
  c_[ns + nf - 1] = clock_shows ? speed : 0.0;
  if (clock_shows) Unsettle();
  known_ = steady_ && taken_.size() < taken_before_.size() &&
           taken_before_[taken_.size()] == sensor;
  if (steady_ && !known_) Unsettle();
  R_ = R;
  if (!known_) Pc_.noalias() = P * c_;
  S_ = known_ ? variances_[sensor] : c_.dot(Pc_) + R;
  last_innovation = innovation - c_.dot(z);
}

void ForceKalman::Correct(Index sensor) {
  // What counts for less leaves more that is not known, without which a filter that has been
  // left behind never comes back.
  if (known_ && inflation > 1.0) {
    Unsettle();
    known_ = false;
    Pc_.noalias() = P * c_;
    S_ = c_.dot(Pc_) + R_;
  }
  taken_.push_back(sensor);
  variance = S_ * inflation;
  if (known_) {
    gain = gains_.col(sensor);
    z += last_innovation * gain;
    return;
  }
  gain = Pc_ / variance;
  z += last_innovation * gain;
  P.noalias() -= gain * Pc_.transpose();
  if (inflation > 1.0) Unsettle();
  gains_.col(sensor) = Pc_ / S_;
  variances_[sensor] = S_;
}

double ForceKalman::Take(Index sensor, bool late, double innovation, double speed) {
  Expect(sensor, late, innovation, speed);
  const double off = std::abs(last_innovation) / std::sqrt(S_);
  inflation = std::max(1.0, off / kCorner);
  Correct(sensor);
  const double cost = inflation > 1.0 ? kCorner * (2.0 * off - kCorner) : off * off;
  return std::log(S_) + cost;
}

void ForceKalman::TakeWeighted(Index sensor, bool late, double innovation, double speed,
                               double weight) {
  Expect(sensor, late, innovation, speed);
  inflation = weight;
  Correct(sensor);
}

void ForceKalman::Unsettle() {
  if (steady_) {
    for (const Index sensor : taken_) {
      P.noalias() -=
          variances_[sensor] * gains_.col(sensor) * gains_.col(sensor).transpose();
    }
  }
  steady_ = false;
  moved_ = true;
}

void ForceKalman::Advance() {
  const Index nf = rho_.size();
  const Index ns = z.size() - nf;
  const MatrixXd& A = tangent_->A;
  z.head(ns) = (A * z.head(ns) + B_ * z.tail(nf)).eval();
  z.tail(nf).array() *= rho_.array();
  if (taken_ != taken_before_) Unsettle();
  std::swap(taken_, taken_before_);
  taken_.clear();
  if (steady_) return;
  top_.noalias() = A * P.topRows(ns);
  top_.noalias() += B_ * P.bottomRows(nf);
  auto states = P.topLeftCorner(ns, ns);
  states.noalias() = top_.leftCols(ns) * A.transpose();
  states.noalias() += top_.rightCols(nf) * B_.transpose();
  states += Q_;
  states = (0.5 * (states + states.transpose())).eval();
  P.topRightCorner(ns, nf) = top_.rightCols(nf) * rho_.asDiagonal();
  P.bottomLeftCorner(nf, ns) = P.topRightCorner(ns, nf).transpose();
  auto forces = P.bottomRightCorner(nf, nf);
  forces = (rho_.asDiagonal() * forces * rho_.asDiagonal()).eval();
  forces.diagonal() += renewal_;
  const VectorXd now = P.diagonal();
  steady_ =
      !moved_ && ((now - before_).cwiseAbs().array() <= kAtItsEnd * now.array()).all();
  before_ = now;
  moved_ = false;
}

}  // namespace mjdiag
