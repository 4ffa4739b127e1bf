#pragma once
// Linear differential-algebraic models, the form in which residuals are synthesised:
//
//   H(p) x + L(p) z + F(p) f = 0                               ([AB383], Eq. 12)
//
// x: what is unknown (states and unknown inputs d), z = [y; u]: what is measured, f:
// faults, p: the differential operator (or a shift). H, L and F are polynomial
// matrices. A residual is N(p) L(p) z for a parity relation N, N H = 0.

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// P(p) = sum_i coefficients[i] p^i; all coefficients of one shape, at least one.
/// [AB383], Eq. 17.
struct PolynomialMatrix {
  std::vector<Eigen::MatrixXd> coefficients;

  int degree() const { return static_cast<int>(coefficients.size()) - 1; }
  Eigen::Index rows() const { return coefficients.front().rows(); }
  Eigen::Index cols() const { return coefficients.front().cols(); }
  Eigen::MatrixXcd At(std::complex<double> p) const;
};

/// left(p) * right(p)
PolynomialMatrix operator*(const PolynomialMatrix& left, const PolynomialMatrix& right);

struct DaeModel {
  PolynomialMatrix H;  ///< (nx + ny) x (nx + nd)
  PolynomialMatrix L;  ///< (nx + ny) x (ny + nu)
  PolynomialMatrix F;  ///< (nx + ny) x nf
};

/// Where a signal enters a state space: B in the states, D in the outputs.
struct SignalEntry {
  Eigen::MatrixXd B;  ///< nx x n
  Eigen::MatrixXd D;  ///< ny x n
};

/// No signal at all: no columns.
SignalEntry NoSignal(const StateSpace& system);

/// [AB383], Eq. 13:
///   H = [-p I + A, B_d; C, D_d],  L = [0, B_u; -I, D_u],  F = [B_f; D_f]
DaeModel MakeDae(const StateSpace& system, const SignalEntry& unknown_inputs,
                 const SignalEntry& faults);

/// The DAE without unknown inputs and without faults.
DaeModel MakeDae(const StateSpace& system);

/// The bar matrix of Eq. 19: (degree + 1) block rows, each with the coefficients of P
/// shifted by one block further, so that a row vector N of that degree has
/// coefficients(N P) = [N_0 .. N_degree] * bar(P).
Eigen::MatrixXd BarMatrix(const PolynomialMatrix& polynomial, int degree);

}  // namespace mjdiag
