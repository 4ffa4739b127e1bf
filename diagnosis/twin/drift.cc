#include "mjdiag/diagnosis/twin/drift.h"

#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Drift::Drift(Index p, std::vector<Index> drifting) : drifting_(std::move(drifting)) {
  const auto r = static_cast<Index>(drifting_.size());
  H_r_ = M_ = MatrixXd::Zero(r, r);
  H_x_ = B_ = MatrixXd::Zero(p, r);
  by_ = MatrixXd::Zero(r, p);
  g_r_ = b_ = rates_ = VectorXd::Zero(r);
  change_ = scale_ = solved_ = VectorXd::Zero(p);
  remaining_ = factor_ = MatrixXd::Zero(p, p);
}

void Drift::Know(const Drift& other) noexcept {
  H_r_ = other.H_r_;
  H_x_ = other.H_x_;
  g_r_ = other.g_r_;
}

void Drift::Start() noexcept {
  H_r_.setZero();
  H_x_.setZero();
  g_r_.setZero();
}

void Drift::Add(const MatrixXd& psi, const MatrixXd& psi_r, const VectorXd& e,
                Index active) noexcept {
  H_r_.noalias() += psi_r.transpose() * psi_r;
  H_x_.topRows(active).noalias() += psi.leftCols(active).transpose() * psi_r;
  g_r_.noalias() += psi_r.transpose() * e;
}

void Drift::Solve(const Information& estimate, double t, double rate_sd) noexcept {
  const Index n = estimate.active();
  const auto r = static_cast<Index>(drifting_.size());
  const MatrixXd& H = estimate.H();
  change_.setZero();
  rates_.setZero();
  gain_ = 0.0;
  remaining_.topLeftCorner(n, n) = H.topLeftCorner(n, n);
  if (r == 0) return;
  auto B = B_.topRows(n);
  B = H_x_.topRows(n);
  M_ = H_r_;
  for (Index i = 0; i < r; ++i) {
    const Index of = drifting_[static_cast<std::size_t>(i)];
    B.col(i) -= t * H.col(of).head(n);
    M_(i, i) += 1.0 / (rate_sd * rate_sd);
    for (Index k = 0; k < r; ++k) {
      const Index other = drifting_[static_cast<std::size_t>(k)];
      M_(i, k) += t * (t * H(of, other) - H_x_(of, k) - H_x_(other, i));
    }
  }
  b_ = g_r_;
  b_.noalias() -= H_x_.topRows(n).transpose() * estimate.change().head(n);
  // M^-1 [B^T, b]
  {
    Eigen::Ref<MatrixXd> in_place = M_;
    const Eigen::LLT<Eigen::Ref<MatrixXd>> decomposed(in_place);
  }
  const auto L = M_.triangularView<Eigen::Lower>();
  auto by = by_.leftCols(n);
  by = B.transpose();
  L.solveInPlace(by);
  rates_ = b_;
  L.solveInPlace(rates_);
  // H* and its solution, in units of its diagonal.
  auto remaining = remaining_.topLeftCorner(n, n);
  remaining.noalias() -= by.transpose() * by;
  auto solved = solved_.head(n);
  solved.noalias() = -by.transpose() * rates_;
  auto scale = scale_.head(n);
  scale = remaining.diagonal().cwiseSqrt().cwiseInverse();
  auto factor = factor_.topLeftCorner(n, n);
  factor = scale.asDiagonal() * remaining * scale.asDiagonal();
  // Rounding of the difference is that of H, which may be far larger.
  factor.diagonal().array() +=
      kRidge * H.diagonal().head(n).array() * scale.array().square();
  Eigen::Ref<MatrixXd> in_place = factor;
  const Eigen::LLT<Eigen::Ref<MatrixXd>> decomposed(in_place);
  if (decomposed.info() != Eigen::Success || !scale.allFinite()) {
    // What a start in motion, not known, and rates tell together is lost in it.
    rates_.setZero();
    remaining = H.topLeftCorner(n, n);
    return;
  }
  solved.array() *= scale.array();
  factor.triangularView<Eigen::Lower>().solveInPlace(solved);
  factor.transpose().triangularView<Eigen::Upper>().solveInPlace(solved);
  change_.head(n) = scale.cwiseProduct(solved);
  rates_.noalias() -= by * change_.head(n);
  M_.transpose().triangularView<Eigen::Upper>().solveInPlace(rates_);
  gain_ = b_.dot(rates_);
}

}  // namespace mjdiag
