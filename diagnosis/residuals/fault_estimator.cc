#include "mjdiag/diagnosis/residuals/fault_estimator.h"

#include <cmath>
#include <unsupported/Eigen/KroneckerProduct>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Smallest eigenvalue of the regressors' correlation matrix at which they still count
/// as independent.
constexpr double kRankTolerance = 1e-10;

VectorXd InverseRoots(const MatrixXd& information) {
  return information.diagonal().unaryExpr(
      [](double power) { return power > 0.0 ? 1.0 / std::sqrt(power) : 0.0; });
}

/// Solves S x = b over b for a correlation matrix S, and factors S = L D L^T over it: L
/// below the diagonal, D L^T above. False if S is singular to working precision: the
/// pivots D bound its smallest eigenvalue from above. Plain loops, because for a few
/// faults Eigen's factorisation takes five times as long.
bool SolveInPlace(MatrixXd& S, VectorXd& b) noexcept {
  const Index n = b.size();
  for (Index j = 0; j < n; ++j) {
    for (Index i = j; i < n; ++i) {
      double rest = S(j, i);
      for (Index k = 0; k < j; ++k) rest -= S(j, k) * S(k, i);
      S(j, i) = rest;
    }
    const double pivot = S(j, j);
    if (!(pivot > kRankTolerance)) return false;
    for (Index i = j + 1; i < n; ++i) S(i, j) = S(j, i) / pivot;
    double rest = b[j];
    for (Index k = 0; k < j; ++k) rest -= S(j, k) * b[k];
    b[j] = rest;
  }
  for (Index j = n - 1; j >= 0; --j) {
    double rest = b[j] / S(j, j);
    for (Index i = j + 1; i < n; ++i) rest -= S(i, j) * b[i];
    b[j] = rest;
  }
  return true;
}

}  // namespace

ResidualNoise MakeResidualNoise(const FilterBank& bank, Index residuals,
                                const VectorXd& noise_sd, int decimation) {
  const Index order = bank.order();
  const Index m = bank.outputs();
  const MatrixXd chain = ChainMatrix(bank);
  // Stage k of residual i is row k m + i of B; here the chain of a residual is
  // together.
  MatrixXd B(order * residuals, bank.inputs());
  MatrixXd C = MatrixXd::Zero(residuals, order * residuals);
  MatrixXd A = MatrixXd::Zero(order * residuals, order * residuals);
  for (Index i = 0; i < residuals; ++i) {
    for (Index k = 0; k < order; ++k) {
      B.row(i * order + k) = bank.B.row(k * m + i) * noise_sd.asDiagonal();
    }
    A.block(i * order, i * order, order, order) = chain;
    C(i, (i + 1) * order - 1) = 1.0;
  }
  const MatrixXd D = bank.D.topRows(residuals) * noise_sd.asDiagonal();

  const MatrixXd equations = MatrixXd::Identity(order * order, order * order) -
                             Eigen::kroneckerProduct(chain, chain).eval();
  const MatrixXd drive = B * B.transpose();
  MatrixXd blocks(order * order, residuals * residuals);
  for (Index i = 0; i < residuals; ++i) {
    for (Index j = 0; j < residuals; ++j) {
      blocks.col(i * residuals + j) =
          drive.block(i * order, j * order, order, order).reshaped();
    }
  }
  blocks = Solve(equations, blocks);
  MatrixXd state(A.rows(), A.cols());
  for (Index i = 0; i < residuals; ++i) {
    for (Index j = 0; j < residuals; ++j) {
      state.block(i * order, j * order, order, order) =
          blocks.col(i * residuals + j).reshaped(order, order);
    }
  }
  MatrixXd power = MatrixXd::Identity(A.rows(), A.cols());
  MatrixXd added = MatrixXd::Zero(A.rows(), A.cols());
  MatrixXd last = power;  // A^(decimation-1)
  for (int i = 0; i < decimation; ++i) {
    added += power * drive * power.transpose();
    last = power;
    power = (power * A).eval();
  }
  return {power, C, state, added, D * D.transpose(), last * B * D.transpose()};
}

FaultEstimator::FaultEstimator(Index faults, ResidualNoise noise, double forgetting,
                               bool at_rest)
    : noise_(std::move(noise)),
      forgetting_(forgetting),
      information_(MatrixXd::Zero(faults, faults)),
      right_(VectorXd::Zero(faults)),
      spread_(MatrixXd::Zero(faults, faults)),
      memory_(MatrixXd::Zero(faults, noise_.A.rows())),
      building_up_(at_rest),
      state_(at_rest ? MatrixXd::Zero(noise_.A.rows(), noise_.A.cols()) : noise_.state),
      output_(noise_.direct),
      ahead_(noise_.carry),
      state_C_(noise_.carry),
      next_state_(noise_.state),
      next_memory_(memory_),
      from_memory_(MatrixXd::Zero(faults, noise_.C.rows())),
      weighted_(from_memory_),
      scaled_(information_),
      scale_(right_),
      solution_(right_) {
  if (!(forgetting > 0.0 && forgetting <= 1.0)) {
    throw InputError("estimator", "forgetting factor " + std::to_string(forgetting),
                     "more than 0 and at most 1");
  }
  UpdateNoise();
}

void FaultEstimator::AssumeStationary() noexcept {
  building_up_ = false;
  state_ = noise_.state;
  UpdateNoise();
}

void FaultEstimator::UpdateNoise() noexcept {
  state_C_.noalias() = state_ * noise_.C.transpose();
  output_ = noise_.direct;
  output_.noalias() += noise_.C * state_C_;
  ahead_ = noise_.carry;
  ahead_.noalias() += noise_.A * state_C_;
}

void FaultEstimator::BuildUp() noexcept {
  next_state_.noalias() = noise_.A * state_;
  state_ = noise_.drive;
  state_.noalias() += next_state_ * noise_.A.transpose();
  UpdateNoise();
  // The variance grows up to that at rest, until rounding is all that is between them.
  constexpr double kNear = 1e-6;  // of the variance of the residual
  const double left = std::abs(output_.trace() - Variance());
  building_up_ = left > kNear * Variance() || left < left_;
  left_ = left;
}

double FaultEstimator::Variance() const noexcept {
  double variance = noise_.direct.trace();
  const Index order = noise_.A.rows() / noise_.C.rows();
  for (Index i = order - 1; i < noise_.A.rows(); i += order) {
    variance += noise_.state(i, i);
  }
  return variance;
}

void FaultEstimator::Add(const Eigen::Ref<const VectorXd>& residuals,
                         const Eigen::Ref<const MatrixXd>& regressors) noexcept {
  // Lazy products: at these sizes the calls of general ones cost more than their work.
  const double lambda = forgetting_;
  information_ = lambda * information_ + regressors.lazyProduct(regressors.transpose());
  right_ = lambda * right_ + regressors.lazyProduct(residuals);

  // m has the weights of right_, so its covariance has their squares.
  from_memory_.noalias() = memory_.lazyProduct(noise_.C.transpose());
  from_memory_ *= lambda;
  weighted_ = from_memory_ + regressors.lazyProduct(output_);
  spread_ = lambda * lambda * spread_ + weighted_.lazyProduct(regressors.transpose()) +
            regressors.lazyProduct(from_memory_.transpose());
  next_memory_ = lambda * memory_.lazyProduct(noise_.A.transpose()) +
                 regressors.lazyProduct(ahead_.transpose());
  memory_.swap(next_memory_);
  if (building_up_) BuildUp();
  ++samples_;
}

void FaultEstimator::Solve(Eigen::Ref<VectorXd> value) noexcept {
  for (Index i = 0; i < scale_.size(); ++i) {
    const double power = information_(i, i);
    scale_[i] = power > 0.0 ? 1.0 / std::sqrt(power) : 0.0;
  }
  scaled_ = information_;
  scaled_.array().colwise() *= scale_.array();
  scaled_.array().rowwise() *= scale_.transpose().array();
  solution_ = right_.cwiseProduct(scale_);
  if (!SolveInPlace(scaled_, solution_)) {
    value.setZero();
    return;
  }
  value = solution_.cwiseProduct(scale_);
}

FaultEstimate FaultEstimator::Estimate() const {
  if (!Inseparable().empty()) {
    throw NumericalError("the regression of the residuals is rank deficient");
  }
  const VectorXd scale = InverseRoots(information_);
  const MatrixXd correlation = scale.asDiagonal() * information_ * scale.asDiagonal();
  const MatrixXd inverse =
      scale.asDiagonal() * Inverse(correlation) * scale.asDiagonal();
  const MatrixXd covariance = inverse * spread_ * inverse;
  return {inverse * right_, 0.5 * (covariance + covariance.transpose())};
}

std::vector<Index> FaultEstimator::Inseparable() const {
  std::vector<Index> faults;
  const VectorXd scale = InverseRoots(information_);
  for (Index i = 0; i < scale.size(); ++i) {
    if (scale[i] == 0.0) faults.push_back(i);
  }
  if (!faults.empty() || scale.size() == 0) return faults;
  const MatrixXd correlation = scale.asDiagonal() * information_ * scale.asDiagonal();
  const SymmetricEigenPairs eigen = SymmetricEigenDecomposition(correlation);
  if (eigen.values[0] > kRankTolerance) return {};
  const VectorXd direction = eigen.vectors.col(0).cwiseAbs();
  constexpr double kShare = 0.1;  // of the largest part
  for (Index i = 0; i < direction.size(); ++i) {
    if (direction[i] > kShare * direction.maxCoeff()) faults.push_back(i);
  }
  return faults;
}

}  // namespace mjdiag
