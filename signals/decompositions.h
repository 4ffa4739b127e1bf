#pragma once
// Eigen's decompositions of dense matrices. They are large templates: translated here
// once, not in every file that solves a system of equations.

#include <Eigen/Core>
#include <vector>

namespace mjdiag {

/// X with A X = B, A square and regular (LU, partial pivoting).
Eigen::MatrixXd Solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::MatrixXcd SolveComplex(const Eigen::MatrixXcd& A, const Eigen::MatrixXcd& B);

/// A^-1, A regular (LU, partial pivoting).
Eigen::MatrixXd Inverse(const Eigen::MatrixXd& A);

/// X that minimises |A X - B| (QR, pivoting of columns).
Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// The same of one right side, by products of vectors: other last bits.
Eigen::VectorXd LeastSquaresOfOne(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The smallest of the X that minimise |A X - B| (complete orthogonal decomposition).
Eigen::MatrixXd LeastNorm(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// A^+ (complete orthogonal decomposition).
Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& A);

/// Q of A = Q R, as many columns as A has (Householder).
Eigen::MatrixXd OrthonormalColumns(const Eigen::MatrixXd& A);

/// Q of A = Q R, square: its first columns span those of A, the others the rest.
Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& A);

/// An orthonormal basis of what the columns of A span to within rounding (QR, pivoting of
/// columns).
Eigen::MatrixXd OrthonormalRange(const Eigen::MatrixXd& A);

/// As many columns of A as span the others (QR, pivoting of columns), increasing.
/// @param threshold  a pivot below so much of the largest is rounding
std::vector<Eigen::Index> IndependentColumns(const Eigen::MatrixXd& A,
                                             double threshold);

struct EigenPairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< in columns
};
/// NumericalError if the iteration does not converge.
EigenPairs EigenDecomposition(const Eigen::MatrixXd& A);

/// Scales s for which row and column norms of diag(s)^-1 A diag(s) are alike: its
/// eigenvalues are those of A and lose fewer digits. Powers of two, so that scaling rounds
/// nothing. Parlett and Reinsch, Numerische Mathematik 13 (1969), 293-304.
Eigen::VectorXd BalancingScales(Eigen::MatrixXd A);

/// The largest modulus of an eigenvalue of A: below 1 where x+ = A x is stable.
double SpectralRadius(const Eigen::MatrixXd& A);

struct SymmetricEigenPairs {
  Eigen::VectorXd values;   ///< increasing
  Eigen::MatrixXd vectors;  ///< orthonormal, in columns
};
SymmetricEigenPairs SymmetricEigenDecomposition(const Eigen::MatrixXd& A);

/// A = diag(scale) V diag(values) V^T diag(scale), scale the root of the diagonal of A:
/// of a covariance or an information of quantities of any units.
struct ScaledEigenPairs {
  Eigen::VectorXd scale;
  Eigen::VectorXd values;  ///< increasing
  Eigen::MatrixXd vectors;
};
/// @param A  symmetric, its diagonal not negative
ScaledEigenPairs ScaledEigenDecomposition(const Eigen::MatrixXd& A);

/// A = U S V^T.
struct SingularValues {
  Eigen::VectorXd values;  ///< decreasing, as many as the shorter side of A
  Eigen::MatrixXd U;       ///< square
  Eigen::MatrixXd V;       ///< as many columns as values; empty if not asked for
};
/// By Jacobi's rotations: small singular values have small relative errors.
SingularValues SingularValueDecomposition(const Eigen::MatrixXd& A);
/// The same values alone, where vectors are not asked for.
Eigen::VectorXd SingularValuesOf(const Eigen::MatrixXd& A);
/// By divide and conquer, without V: for large matrices.
SingularValues LeftSingularVectors(const Eigen::MatrixXd& A);

}  // namespace mjdiag
