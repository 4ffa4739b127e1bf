#include "mjdiag/diagnosis/twin/whitened_block.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kReadings = 2;
constexpr Index kTicks = 3;
constexpr Index kUnknowns = 4;

/// Innovations, what they are sensitive to, and their covariance in a tick.
struct Block {
  MatrixXd e = MatrixXd::Random(kReadings, kTicks);
  MatrixXd psi = MatrixXd::Random(kReadings * kTicks, kUnknowns);
  MatrixXd rates = MatrixXd::Random(kReadings * kTicks, 1);
  MatrixXd covariance = (MatrixXd(2, 2) << 2.0, 0.6, 0.6, 0.5).finished();
};

/// @param reading  NaN in those that are missing
WhitenedBlock Whitened(const Block& block, const MatrixXd& reading) {
  WhitenedBlock whitened(kReadings, kTicks, kUnknowns, 1);
  whitened.Start();
  for (Index k = 0; k < kTicks; ++k) {
    EXPECT_FALSE(whitened.full());
    whitened.Add(block.e.col(k), reading.col(k));
  }
  EXPECT_TRUE(whitened.full());
  whitened.Whiten(block.psi, kUnknowns, &block.rates, block.covariance);
  return whitened;
}

TEST(WhitenedBlock, WeighsEveryTickByTheInverseOfItsCovariance) {
  const Block block;
  const WhitenedBlock whitened = Whitened(block, MatrixXd::Zero(kReadings, kTicks));
  MatrixXd W = MatrixXd::Zero(kReadings * kTicks, kReadings * kTicks);
  for (Index k = 0; k < kTicks; ++k) {
    W.block(2 * k, 2 * k, 2, 2) = block.covariance.inverse();
  }
  const VectorXd e = block.e.reshaped();
  EXPECT_TRUE((whitened.psi().transpose() * whitened.psi())
                  .isApprox(block.psi.transpose() * W * block.psi, 1e-12));
  EXPECT_TRUE((whitened.rates().transpose() * whitened.psi())
                  .isApprox(block.rates.transpose() * W * block.psi, 1e-12));
  EXPECT_TRUE((whitened.psi().transpose() * whitened.e())
                  .isApprox(block.psi.transpose() * W * e, 1e-12));
}

// Of a pair that is correlated, the one that is left has its own variance.
TEST(WhitenedBlock, LeavesOutWhatWasNotMeasured) {
  const Block block;
  MatrixXd reading = MatrixXd::Zero(kReadings, kTicks);
  reading(0, 1) = std::numeric_limits<double>::quiet_NaN();
  const WhitenedBlock whitened = Whitened(block, reading);
  MatrixXd H = MatrixXd::Zero(kUnknowns, kUnknowns);
  VectorXd g = VectorXd::Zero(kUnknowns);
  for (Index k = 0; k < kTicks; ++k) {
    MatrixXd psi = block.psi.middleRows(2 * k, 2);
    VectorXd e = block.e.col(k);
    MatrixXd covariance = block.covariance;
    if (k == 1) {
      psi = psi.bottomRows(1).eval();
      e = e.tail(1).eval();
      covariance = covariance.bottomRightCorner(1, 1).eval();
    }
    H += psi.transpose() * covariance.inverse() * psi;
    g += psi.transpose() * covariance.inverse() * e;
  }
  EXPECT_TRUE((whitened.psi().transpose() * whitened.psi()).isApprox(H, 1e-12));
  EXPECT_TRUE((whitened.psi().transpose() * whitened.e()).isApprox(g, 1e-12));
  EXPECT_TRUE(whitened.any());
}

// What all ticks have in common: of unit noise, and as large as the root of their number.
TEST(WhitenedBlock, ShowsWhatIsSlow) {
  Block block;
  block.covariance = MatrixXd::Identity(kReadings, kReadings);
  block.e.setConstant(0.7);
  block.psi.setConstant(0.2);
  MatrixXd reading = MatrixXd::Zero(kReadings, kTicks);
  reading(1, 2) = std::numeric_limits<double>::quiet_NaN();
  const WhitenedBlock whitened = Whitened(block, reading);
  const Eigen::Vector2d root(std::sqrt(3.0), std::sqrt(2.0));
  EXPECT_TRUE(whitened.slow_e().isApprox(0.7 * root, 1e-12));
  for (Index i = 0; i < kUnknowns; ++i) {
    EXPECT_TRUE(whitened.slow_psi().col(i).isApprox(0.2 * root, 1e-12));
  }
}

TEST(WhitenedBlock, CountsLessByItsDiscount) {
  const Block block;
  const MatrixXd reading = MatrixXd::Zero(kReadings, kTicks);
  const WhitenedBlock whole = Whitened(block, reading);
  WhitenedBlock less = whole;
  less.Discount(4.0);
  EXPECT_TRUE((4.0 * less.psi().transpose() * less.e())
                  .isApprox(whole.psi().transpose() * whole.e(), 1e-12));
  EXPECT_TRUE((4.0 * less.rates().transpose() * less.rates())
                  .isApprox(whole.rates().transpose() * whole.rates(), 1e-12));
}

}  // namespace
}  // namespace mjdiag
