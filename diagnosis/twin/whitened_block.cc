#include "mjdiag/diagnosis/twin/whitened_block.h"

#include <cmath>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The factor is one of something, so that it can be copied before it is used.
WhitenedBlock::WhitenedBlock(Index ny, Index ticks, Index p, Index rates)
    : factor_(MatrixXd::Identity(ny, ny)) {
  measured_ = slow_e_ = VectorXd::Zero(ny);
  e_ = there_ = VectorXd::Zero(ny * ticks);
  psi_ = MatrixXd::Zero(ny * ticks, p);
  rates_ = MatrixXd::Zero(ny * ticks, rates);
  slow_psi_ = MatrixXd::Zero(ny, p);
  covariance_ = root_ = MatrixXd::Identity(ny, ny);
}

void WhitenedBlock::Start() noexcept {
  ticks_ = 0;
  measured_.setZero();
}

void WhitenedBlock::Add(const VectorXd& innovation,
                        const Eigen::Ref<const VectorXd>& reading) noexcept {
  const Index ny = measured_.size();
  for (Index i = 0; i < ny; ++i) {
    const bool measured = !std::isnan(reading[i]);
    e_[ticks_ * ny + i] = measured ? innovation[i] : 0.0;
    there_[ticks_ * ny + i] = measured ? 1.0 : 0.0;
    if (measured) measured_[i] += 1.0;
  }
  ++ticks_;
}

void WhitenedBlock::Whiten(const MatrixXd& psi, Index active, const MatrixXd* rates,
                           const MatrixXd& covariance) noexcept {
  const Index ny = measured_.size();
  active_ = active;
  growing_ = rates != nullptr ? rates_.cols() : 0;
  psi_.leftCols(active) = psi.leftCols(active);
  if (rates != nullptr) rates_ = *rates;
  const auto whole = static_cast<double>(ticks_);
  const bool complete = measured_.minCoeff() == whole;
  const auto root_of = [&](const MatrixXd& of_tick) {
    factor_.compute(of_tick);
    root_.setIdentity();
    factor_.matrixL().solveInPlace(root_);
  };
  if (complete) root_of(covariance);
  slow_e_.setZero();
  slow_psi_.leftCols(active).setZero();
  for (Index tick = 0; tick < ticks_; ++tick) {
    if (!complete) {
      covariance_ = covariance;
      for (Index i = 0; i < ny; ++i) {
        if (there_[tick * ny + i] > 0.0) continue;
        covariance_.row(i).setZero();
        covariance_.col(i).setZero();
        covariance_(i, i) = 1.0;
        psi_.row(tick * ny + i).setZero();
        rates_.row(tick * ny + i).setZero();
      }
      root_of(covariance_);
    }
    WhitenTick(tick);
    slow_e_ += e_.segment(tick * ny, ny);
    slow_psi_.leftCols(active) += psi_.middleRows(tick * ny, ny).leftCols(active);
  }
  for (Index i = 0; i < ny; ++i) {
    const double scale = measured_[i] > 0.0 ? 1.0 / std::sqrt(measured_[i]) : 0.0;
    slow_e_[i] *= scale;
    slow_psi_.row(i).head(active) *= scale;
  }
}

void WhitenedBlock::WhitenTick(Index tick) noexcept {
  const Index ny = measured_.size();
  const auto whiten = [&](double* of_tick) {
    for (Index i = ny - 1; i >= 0; --i) {
      double sum = 0.0;
      for (Index j = 0; j <= i; ++j) sum += root_(i, j) * of_tick[j];
      of_tick[i] = sum;
    }
  };
  whiten(e_.data() + tick * ny);
  for (Index i = 0; i < active_; ++i) whiten(psi_.col(i).data() + tick * ny);
  for (Index i = 0; i < growing_; ++i) whiten(rates_.col(i).data() + tick * ny);
}

void WhitenedBlock::Discount(double times) noexcept {
  const double scale = 1.0 / std::sqrt(times);
  e_ *= scale;
  psi_.leftCols(active_) *= scale;
  rates_.leftCols(growing_) *= scale;
}

}  // namespace mjdiag
