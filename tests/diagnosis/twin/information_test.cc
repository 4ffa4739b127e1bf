#include "mjdiag/diagnosis/twin/information.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cstddef>
#include <memory>
#include <new>

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Eigen::Index kUnknowns = 3;
constexpr Eigen::Index kReadings = 2;

Information Started() {
  Information information(kUnknowns, kReadings);
  information.Start(kUnknowns, MatrixXd::Identity(kUnknowns, kUnknowns),
                    VectorXd::Zero(kUnknowns));
  return information;
}

// H^-1 g with H = I + psi^T psi, g = psi^T e.
TEST(Information, AddsABlockAsLeastSquaresDo) {
  MatrixXd psi(kReadings, kUnknowns);
  psi << 1.0, 2.0, 0.0, -1.0, 0.5, 3.0;
  const VectorXd e = Eigen::Vector2d(0.3, -0.7);
  Information information = Started();
  information.Add(psi, e);
  const MatrixXd H = MatrixXd::Identity(kUnknowns, kUnknowns) + psi.transpose() * psi;
  const VectorXd g = psi.transpose() * e;
  EXPECT_TRUE(information.H().isApprox(H, 1e-12));
  EXPECT_TRUE(information.change().isApprox(H.inverse() * g, 1e-11));
  EXPECT_TRUE(information.Variance().isApprox(H.inverse().diagonal(), 1e-11));
}

// An estimator begins with a copy of one that has added nothing. What a copy reads of it
// uninitialised only the sanitizer of undefined behaviour sees, in memory that was used
// before.
TEST(Information, IsCopiedBeforeAnythingIsAdded) {
  const MatrixXd psi = MatrixXd::Identity(kReadings, kUnknowns);
  const VectorXd e = VectorXd::Ones(kReadings);
  alignas(Information) std::array<std::byte, sizeof(Information)> used;
  used.fill(std::byte{0xbe});
  auto* const fresh = new (used.data()) Information(kUnknowns, kReadings);
  Information copy = *fresh;
  std::destroy_at(fresh);
  copy.Start(kUnknowns, MatrixXd::Identity(kUnknowns, kUnknowns),
             VectorXd::Zero(kUnknowns));
  Information first = Started();
  first.Add(psi, e);
  copy.Add(psi, e);
  EXPECT_EQ(copy.change(), first.change());
}

}  // namespace
}  // namespace mjdiag
