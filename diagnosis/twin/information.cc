#include "mjdiag/diagnosis/twin/information.h"

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd CovarianceOf(const MatrixXd& H) {
  const VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * Inverse(scale.asDiagonal() * H * scale.asDiagonal()) *
         scale.asDiagonal();
}

// Of something, so that it can be copied before it is used.
Information::Information(Index p, Index ny) : small_(MatrixXd::Identity(ny, ny)) {
  H_ = factor_ = inverse_ = MatrixXd::Identity(p, p);
  g_ = change_ = scale_ = solution_ = VectorXd::Zero(p);
  variance_ = VectorXd::Ones(p);
  corrected_ = whitened_ = VectorXd::Zero(ny);
  spread_ = MatrixXd::Zero(p, ny);
  expected_ = MatrixXd::Zero(ny, ny);
}

void Information::Know(const Information& other) noexcept {
  active_ = other.active_;
  H_.topLeftCorner(active_, active_) = other.H_.topLeftCorner(active_, active_);
  factor_.topLeftCorner(active_, active_) =
      other.factor_.topLeftCorner(active_, active_);
  scale_.head(active_) = other.scale_.head(active_);
  g_.head(active_) = other.g_.head(active_);
  change_ = other.change_;
}

void Information::Start(Index active, const MatrixXd& prior,
                        const VectorXd& away) noexcept {
  active_ = active;
  H_ = prior;
  g_.noalias() = prior * away;
  change_.setZero();
  Factorise();
}

void Information::Factorise() noexcept {
  auto scale = scale_.head(active_);
  scale = H_.diagonal().head(active_).cwiseSqrt().cwiseInverse();
  auto factor = factor_.topLeftCorner(active_, active_);
  factor = scale.asDiagonal() * H_.topLeftCorner(active_, active_) * scale.asDiagonal();
  factor.diagonal().array() += kRidge;
  Eigen::Ref<MatrixXd> in_place = factor;
  const Eigen::LLT<Eigen::Ref<MatrixXd>> decomposed(in_place);
}

void Information::Solve() noexcept {
  auto solution = solution_.head(active_);
  const auto L = factor_.topLeftCorner(active_, active_);
  solution = scale_.head(active_).cwiseProduct(g_.head(active_));
  L.triangularView<Eigen::Lower>().solveInPlace(solution);
  L.transpose().triangularView<Eigen::Upper>().solveInPlace(solution);
  change_.head(active_) = scale_.head(active_).cwiseProduct(solution);
}

double Information::NormalizedInnovation(const MatrixXd& psi,
                                         const VectorXd& e) noexcept {
  const auto seen = psi.leftCols(active_);
  corrected_ = e;
  corrected_.noalias() -= seen * change_.head(active_);
  auto spread = spread_.topRows(active_);
  spread = scale_.head(active_).asDiagonal() * seen.transpose();
  factor_.topLeftCorner(active_, active_)
      .triangularView<Eigen::Lower>()
      .solveInPlace(spread);
  expected_.setIdentity();
  expected_.noalias() += spread.transpose() * spread;
  small_.compute(expected_);
  whitened_ = corrected_;
  small_.solveInPlace(whitened_);
  return corrected_.dot(whitened_) / static_cast<double>(e.size());
}

void Information::Add(const MatrixXd& psi, const VectorXd& e) noexcept {
  const auto seen = psi.leftCols(active_);
  H_.topLeftCorner(active_, active_).noalias() += seen.transpose() * seen;
  g_.head(active_).noalias() += seen.transpose() * e;
  Factorise();
  Solve();
}

double Information::SquaredChange() const { return change_.dot(g_); }

const VectorXd& Information::Variance() noexcept {
  auto inverse = inverse_.topLeftCorner(active_, active_);
  inverse.setIdentity();
  factor_.topLeftCorner(active_, active_)
      .triangularView<Eigen::Lower>()
      .solveInPlace(inverse);
  variance_.head(active_) = scale_.head(active_).cwiseAbs2().cwiseProduct(
      inverse.colwise().squaredNorm().transpose());
  return variance_;
}

void Information::Discount(const MatrixXd& prior, const VectorXd& away,
                           double times) noexcept {
  solution_.noalias() = prior * away;
  H_ = prior + (H_ - prior) / times;
  g_ = solution_ + (g_ - solution_) / times;
  Factorise();
  Solve();
}

void Information::Recentre() noexcept {
  g_.setZero();
  change_.setZero();
}

void Information::Assume(const MatrixXd& H) noexcept {
  H_.topLeftCorner(active_, active_) = H.topLeftCorner(active_, active_);
  Recentre();
  Factorise();
}

void Information::Walk(const VectorXd& variance) noexcept {
  // (H^-1 + Q)^-1, by H^-1 = S L^-T L^-1 S.
  auto inverse = inverse_.topLeftCorner(active_, active_);
  auto factor = factor_.topLeftCorner(active_, active_);
  const auto scale = scale_.head(active_);
  inverse.setIdentity();
  factor.triangularView<Eigen::Lower>().solveInPlace(inverse);
  auto covariance = H_.topLeftCorner(active_, active_);
  covariance.noalias() = inverse.transpose() * inverse;
  // In units of the diagonal of H, then of its own.
  covariance.diagonal().array() +=
      variance.head(active_).array() / scale.array().square();
  auto own = solution_.head(active_);
  own = covariance.diagonal().cwiseSqrt().cwiseInverse();
  factor = own.asDiagonal() * covariance * own.asDiagonal();
  {
    Eigen::Ref<MatrixXd> in_place = factor;
    const Eigen::LLT<Eigen::Ref<MatrixXd>> decomposed(in_place);
  }
  inverse.setIdentity();
  factor.triangularView<Eigen::Lower>().solveInPlace(inverse);
  covariance.noalias() = inverse.transpose() * inverse;
  own.array() /= scale.array();
  covariance = own.asDiagonal() * covariance * own.asDiagonal();
  g_.head(active_).noalias() = covariance * change_.head(active_);
  Factorise();
  Solve();
}

}  // namespace mjdiag
