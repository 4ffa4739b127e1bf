#include "mjdiag/plugin/replay/noise_slope.h"

#include <cmath>
#include <utility>
#include <vector>

#include "mjdiag/plugin/replay/linear_pass.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Ticks of a part.
constexpr Index kPart = 20;

/// What the pass forwards keeps of a reading.
struct Reading {
  Index sensor = 0;
  bool late = false;
  double e = 0.0;
  double S = 0.0;
  bool cut = false;  // beyond Huber's corner
};

class Backwards {
 public:
  Backwards(const FilterPath& path, const FilterNoise& noise, Index first, Index count)
      : path_(path),
        noise_(noise),
        first_(first),
        count_(count),
        nf_(path.dof_count()),
        n_(path.pulled.rows()),
        ns_(n_ - nf_ - 1),
        pass_(path, noise) {}

  NoiseSlope Run();

 private:
  void Forwards();
  NoiseSlope Back();
  /// Whether a slope is one: -2 ln L is no steeper than what readings add to it, some times.
  bool IsSlope(const VectorXd& slope) const;
  void Tick(Index k);
  /// @return the slope by the variance of that reading
  double Take(Index place);
  VectorXd Slope() const;

  const FilterPath& path_;
  const FilterNoise& noise_;
  Index first_, count_, nf_, n_, ns_;
  LinearPass pass_;
  double deviance_ = 0.0;
  double steepest_ = 0.0;  // what readings add
  // Whether what a cut reading is taken for stays as it is. A reading beyond the corner
  // corrects by the same whatever it is: a machine that falls falls on by first order, though
  // all of its readings together hold it.
  bool keeps_weights_ = false;
  std::vector<Reading> readings_;
  std::vector<Index> ends_;  // of the readings of every tick
  MatrixXd u_, c_;           // n x readings
  MatrixXd P_;     // columns of [w; t] before the readings of a tick, side by side
  MatrixXd last_;  // [w; t] at the end of a tick, with what the path has of it
  // Adjoints, and slopes by rho, by what is new of [w; t], by white^2 and by reading^2.
  VectorXd Z_, by_rho_, by_renewal_, by_white_, by_reading_, by_start_;
  MatrixXd Q_, QF_;
  VectorXd du_;
};

void Backwards::Forwards() {
  const Index all = path_.counts.middleCols(first_, count_).count();
  u_.resize(n_, all);
  c_.resize(n_, all);
  P_.resize(n_, count_ * (nf_ + 1));
  last_.resize(nf_ + 1, count_);
  readings_.reserve(static_cast<std::size_t>(all));
  pass_.at_tick = [&](Index k) {
    P_.middleCols((k - first_) * (nf_ + 1), nf_ + 1) =
        pass_.kalman.P.rightCols(nf_ + 1);
  };
  pass_.at_reading = [&](Index sensor, Index, bool late, double deviance) {
    const ForceKalman& kalman = pass_.kalman;
    const auto place = std::ssize(readings_);
    deviance_ += deviance;
    steepest_ += 1.0 + std::pow(kalman.last_innovation, 2) / kalman.variance;
    u_.col(place) = kalman.variance * kalman.gain;
    c_.col(place) = kalman.c();
    readings_.push_back({sensor, late, kalman.last_innovation,
                         kalman.variance / kalman.inflation, kalman.inflation > 1.0});
  };
  pass_.at_advance = [&](Index k) {
    auto last = last_.col(k - first_);
    last = pass_.kalman.z.tail(nf_ + 1);
    last.head(nf_) += path_.forces.col(k);
    last[nf_] += path_.clock[k];
    ends_.push_back(std::ssize(readings_));
  };
  pass_.Over(first_, count_);
}

double Backwards::Take(Index place) {
  const Reading& one = readings_[static_cast<std::size_t>(place)];
  const auto u = u_.col(place);
  const auto c = c_.col(place);
  const double root = std::sqrt(one.S);
  constexpr double kCorner = ForceKalman::kCorner;
  const double V = one.cut ? std::abs(one.e) * root / kCorner : one.S;
  const double Zu = Z_.dot(u);
  du_.noalias() = Q_ * u;
  const double uQu = u.dot(du_);
  const double by_V = one.cut && keeps_weights_ ? 0.0 : (uQu - one.e * Zu) / (V * V);
  double by_S = 1.0 / one.S;
  double by_e = Zu / V;
  if (one.cut) {
    by_S += 0.5 * by_V * V / one.S - kCorner * std::abs(one.e) / (one.S * root);
    by_e += std::copysign(2.0 * kCorner, one.e) / root + by_V * V / one.e;
  } else {
    by_S += by_V - one.e * one.e / (one.S * one.S);
    by_e += 2.0 * one.e / one.S;
  }
  du_ = (one.e * Z_ - 2.0 * du_) / V + by_S * c;
  Q_.noalias() += 0.5 * du_ * c.transpose();
  Q_.noalias() += 0.5 * c * du_.transpose();
  Z_ -= by_e * c;
  by_reading_[one.sensor] += by_S;
  return by_S;
}

void Backwards::Tick(Index k) {
  const TickTangent& tangent = path_.At(first_ + k);
  const VectorXd& rho = pass_.kalman.rho();
  const auto tail = Z_.tail(nf_ + 1);
  if (k + 1 < count_) {
    const auto P = P_.middleCols((k + 1) * (nf_ + 1), nf_ + 1);
    for (Index j = 0; j <= nf_; ++j) {
      const Index place = ns_ + j;
      const double variance = j < nf_ ? noise_.size[j] : noise_.clock;
      const double renewal = (1.0 - rho[j] * rho[j]) * variance * variance;
      // F P before what is new came to it, of that column.
      const double QFP = Q_.col(place).dot(P.col(j)) - Q_(place, place) * renewal;
      by_rho_[j] += tail[j] * last_(j, k) + 2.0 * QFP / rho[j];
      by_renewal_[j] += Q_(place, place);
    }
  }
  QF_.leftCols(ns_).noalias() = Q_.leftCols(ns_) * tangent.A;
  for (Index j = 0; j <= nf_; ++j) {
    QF_.col(ns_ + j) = rho[j] * Q_.col(ns_ + j);
    if (j == nf_) break;
    const auto b = tangent.B.col(path_.dofs[static_cast<std::size_t>(j)]);
    const VectorXd Qb = Q_.leftCols(ns_) * b;
    by_white_[j] += b.dot(Qb.head(ns_));
    QF_.col(ns_ + j) += Qb;
  }
  Q_.topRows(ns_).noalias() = tangent.A.transpose() * QF_.topRows(ns_);
  for (Index j = 0; j <= nf_; ++j) {
    Q_.row(ns_ + j) = rho[j] * QF_.row(ns_ + j);
    if (j == nf_) break;
    const auto b = tangent.B.col(path_.dofs[static_cast<std::size_t>(j)]);
    Q_.row(ns_ + j).noalias() += b.transpose() * QF_.topRows(ns_);
    Z_[ns_ + j] = rho[j] * Z_[ns_ + j] + b.dot(Z_.head(ns_));
  }
  // No reading takes from what rounding leaves unlike on both sides, which grows along with what
  // is unstable: an arm that stands upright.
  QF_ = Q_;
  Q_ = 0.5 * (QF_ + QF_.transpose());
  Z_[n_ - 1] *= rho[nf_];
  Z_.head(ns_) = (tangent.A.transpose() * Z_.head(ns_)).eval();
  const Index begin = k > 0 ? ends_[static_cast<std::size_t>(k - 1)] : 0;
  for (Index i = ends_[static_cast<std::size_t>(k)] - 1; i >= begin; --i) {
    const double by_S = Take(i);
    const Reading& one = readings_[static_cast<std::size_t>(i)];
    if (!one.late) continue;
    for (Index j = 0; j < nf_; ++j) {
      const double d = tangent.D(one.sensor, path_.dofs[static_cast<std::size_t>(j)]);
      by_white_[j] += by_S * d * d;
    }
  }
}

VectorXd Backwards::Slope() const {
  const VectorXd& rho = pass_.kalman.rho();
  const Index ny = noise_.reading.size();
  VectorXd slope(3 * nf_ + ny + 2);
  for (Index j = 0; j <= nf_; ++j) {
    const double size = j < nf_ ? noise_.size[j] : noise_.clock;
    const double memory = j < nf_ ? noise_.memory[j] : noise_.clock_memory;
    const double by_size =
        2.0 * size * size * ((1.0 - rho[j] * rho[j]) * by_renewal_[j] + by_start_[j]);
    const double by_memory = rho[j] * path_.sample_time / memory *
                             (by_rho_[j] - 2.0 * rho[j] * size * size * by_renewal_[j]);
    const double by_floor =
        j < nf_ ? noise_.floor * size * size * memory / path_.sample_time * by_white_[j]
                : 0.0;
    slope[j < nf_ ? j : 3 * nf_ + ny] = by_size + 2.0 * by_floor;
    slope[j < nf_ ? nf_ + j : 3 * nf_ + ny + 1] = by_memory + by_floor;
  }
  slope.segment(2 * nf_, nf_) = 2.0 * noise_.white.array().square() * by_white_.array();
  slope.segment(3 * nf_, ny) =
      2.0 * noise_.reading.array().square() * by_reading_.array();
  return slope;
}

bool Backwards::IsSlope(const VectorXd& slope) const {
  constexpr double kTimes = 100.0;
  return slope.allFinite() && slope.norm() < kTimes * steepest_;
}

NoiseSlope Backwards::Run() {
  Forwards();
  NoiseSlope slope = Back();
  if (IsSlope(slope.slope)) return slope;
  keeps_weights_ = true;
  return Back();
}

NoiseSlope Backwards::Back() {
  Z_ = VectorXd::Zero(n_);
  Q_ = MatrixXd::Zero(n_, n_);
  QF_ = MatrixXd::Zero(n_, n_);
  du_ = VectorXd::Zero(n_);
  by_rho_ = by_renewal_ = by_start_ = VectorXd::Zero(nf_ + 1);
  by_white_ = VectorXd::Zero(nf_);
  by_reading_ = VectorXd::Zero(noise_.reading.size());
  MatrixXd parts(3 * nf_ + by_reading_.size() + 2, (count_ - 1) / kPart + 1);
  VectorXd later = VectorXd::Zero(parts.rows());
  for (Index k = count_ - 1; k >= 0; --k) {
    Tick(k);
    if (k % kPart != 0) continue;
    if (k == 0) by_start_ = Q_.diagonal().tail(nf_ + 1);
    const VectorXd until = Slope();
    parts.col(k / kPart) = until - later;
    later = until;
  }
  return {deviance_, std::move(later), std::move(parts)};
}

}  // namespace

NoiseSlope SlopeAlong(const FilterPath& path, const FilterNoise& noise, Index first,
                      Index count) {
  return Backwards(path, noise, first, count).Run();
}

}  // namespace mjdiag
