#include "mjdiag/signals/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
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

EigenPairs EigenDecomposition(const MatrixXd& A) {
  const Eigen::EigenSolver<MatrixXd> eigen(A);
  if (eigen.info() != Eigen::Success) {
    throw NumericalError("the eigenvalues do not converge");
  }
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

double SpectralRadius(const MatrixXd& A) {
  return Eigen::EigenSolver<MatrixXd>(A, false).eigenvalues().cwiseAbs().maxCoeff();
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
