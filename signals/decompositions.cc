#include "mjdiag/signals/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

MatrixXd Solve(const MatrixXd& A, const MatrixXd& B) {
  return Eigen::PartialPivLU<MatrixXd>(A).solve(B);
}

MatrixXcd SolveComplex(const MatrixXcd& A, const MatrixXcd& B) {
  return Eigen::PartialPivLU<MatrixXcd>(A).solve(B);
}

MatrixXd Inverse(const MatrixXd& A) {
  return Eigen::PartialPivLU<MatrixXd>(A).inverse();
}

MatrixXd LeastSquares(const MatrixXd& A, const MatrixXd& B) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(A).solve(B);
}

Eigen::VectorXd LeastSquaresOfOne(const MatrixXd& A, const Eigen::VectorXd& b) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(A).solve(b);
}

MatrixXd LeastNorm(const MatrixXd& A, const MatrixXd& B) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(A).solve(B);
}

MatrixXd PseudoInverse(const MatrixXd& A) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(A).pseudoInverse();
}

MatrixXd OrthonormalColumns(const MatrixXd& A) {
  return Eigen::HouseholderQR<MatrixXd>(A).householderQ() *
         MatrixXd::Identity(A.rows(), A.cols());
}

MatrixXd OrthonormalBasis(const MatrixXd& A) {
  return Eigen::HouseholderQR<MatrixXd>(A).householderQ();
}

MatrixXd OrthonormalRange(const MatrixXd& A) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  return MatrixXd(qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols()))
      .leftCols(qr.rank());
}

std::vector<Eigen::Index> IndependentColumns(const MatrixXd& A, double threshold) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  qr.setThreshold(threshold);
  const auto& order = qr.colsPermutation().indices();
  std::vector<Eigen::Index> columns(order.data(), order.data() + qr.rank());
  std::ranges::sort(columns);
  return columns;
}

EigenPairs EigenDecomposition(const MatrixXd& A) {
  const Eigen::EigenSolver<MatrixXd> eigen(A);
  if (eigen.info() != Eigen::Success) {
    throw NumericalError("the eigenvalues do not converge");
  }
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd BalancingScales(MatrixXd A) {
  constexpr int kMaxSweeps = 100;
  constexpr double kWorthwhile = 0.95;
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(A.rows());
  bool changed = true;
  for (int sweep = 0; changed && sweep < kMaxSweeps; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const double diagonal = std::abs(A(i, i));
      const double column = A.col(i).lpNorm<1>() - diagonal;
      const double row = A.row(i).lpNorm<1>() - diagonal;
      if (column == 0.0 || row == 0.0) continue;
      const double scale = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (column * scale + row / scale >= kWorthwhile * (column + row)) continue;
      A.col(i) *= scale;
      A.row(i) /= scale;
      scales[i] *= scale;
      changed = true;
    }
  }
  return scales;
}

double SpectralRadius(const MatrixXd& A) {
  const Eigen::VectorXd scales = BalancingScales(A);
  const MatrixXd balanced =
      scales.cwiseInverse().asDiagonal() * A * scales.asDiagonal();
  return Eigen::EigenSolver<MatrixXd>(balanced, false)
      .eigenvalues()
      .cwiseAbs()
      .maxCoeff();
}

SymmetricEigenPairs SymmetricEigenDecomposition(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

ScaledEigenPairs ScaledEigenDecomposition(const MatrixXd& A) {
  // A quantity that nothing tells has a scale all the same.
  const Eigen::VectorXd scale =
      A.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  const Eigen::VectorXd unit = scale.cwiseInverse();
  SymmetricEigenPairs pairs =
      SymmetricEigenDecomposition(unit.asDiagonal() * A * unit.asDiagonal());
  return {scale, std::move(pairs.values), std::move(pairs.vectors)};
}

SingularValues SingularValueDecomposition(const MatrixXd& A) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeFullU | Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

Eigen::VectorXd SingularValuesOf(const MatrixXd& A) {
  return Eigen::JacobiSVD<MatrixXd>(A).singularValues();
}

SingularValues LeftSingularVectors(const MatrixXd& A) {
  const Eigen::BDCSVD<MatrixXd> svd(A, Eigen::ComputeFullU);
  return {svd.singularValues(), svd.matrixU(), {}};
}

}  // namespace mjdiag
